#include "tools/evaluate/options.h"

#include <functional>
#include <map>

#include "perennial/core/error.h"

namespace perennial {

const char* const kEvaluateUsage =
    R"(usage: evaluate INPUT --out DIR (--strategy NAME [--set KEY=VALUE]... | --sweep FILE.yaml [--set KEY=VALUE]...)

Teaches every place of a data set from its first traversal, then registers every later one
in order of time and lets the map learn from it. Writes errors.csv, lives.csv, cost.csv and
summary.json to DIR, or, for a sweep, to a folder of DIR for each run. Runs that are complete already are not repeated.

INPUT is a folder with manifest.csv, or with maps of the reference system, or one or more bags (FILE.bag ...) with:

  --ground-truth FILE.csv  traversal, stamp, distance_m and offset_px of the bags' images; docs/evaluation.md
  --image-topic NAME       default: /camera/image_raw

  --set KEY=VALUE   a parameter of the strategy, or of a group: registration/ratio, extraction/features,
                    map_manager/min_inliers_for_update, map_manager/min_confidence_for_update
  --sweep FILE      runs a grid of strategies and parameters
  --teach NAME      traversal that teaches instead of the first
  --from NAME, --to NAME   first and last traversal to register
  --skip-first N    leave the first N registrations of each place out of the results; the map learns from them all the same
  --repeat N        repeat each place's views until there are N, as if the same days came again: what a map costs in the long
                    run
  --stored-features  those in the maps of the reference system, instead of extracting our own from their images
  --threads N       default: one per processor
  --cache DIR       where extracted features are kept, default: ~/.cache/perennial_nav/features
)";

namespace {

unsigned count(const std::string& option, const std::string& text) {
  if (text.empty() || text.size() > 6 || text.find_first_not_of("0123456789") != std::string::npos) {
    throw ParameterError(option + " takes a number, not '" + text + "'");
  }
  return static_cast<unsigned>(std::stoul(text));
}

bool isBag(const std::string& word) {
  return word.size() > 4 && word.compare(word.size() - 4, 4, ".bag") == 0;
}

void requireWhole(const EvaluateOptions& options) {
  const bool input = options.bags.empty() != options.dataset.empty();
  if (!input || options.out.empty() || options.strategy.empty() == options.sweep.empty()) {
    throw ParameterError("a data set or bags, --out and one of --strategy and --sweep are needed");
  }
  if (options.bags.empty() != options.ground_truth.empty()) {
    throw ParameterError("bags need --ground-truth, and nothing else takes it");
  }
}

}  // namespace

EvaluateOptions parseEvaluateOptions(const std::vector<std::string>& arguments) {
  EvaluateOptions options;
  const std::map<std::string, std::function<void(const std::string&)>> known = {
      {"--out", [&](const std::string& value) { options.out = value; }},
      {"--strategy", [&](const std::string& value) { options.strategy = value; }},
      {"--sweep", [&](const std::string& value) { options.sweep = value; }},
      {"--set", [&](const std::string& value) { options.assignments.push_back(value); }},
      {"--teach", [&](const std::string& value) { options.selection.teach = value; }},
      {"--from", [&](const std::string& value) { options.selection.from = value; }},
      {"--to", [&](const std::string& value) { options.selection.to = value; }},
      {"--ground-truth", [&](const std::string& value) { options.ground_truth = value; }},
      {"--image-topic", [&](const std::string& value) { options.image_topic = value; }},
      {"--skip-first", [&](const std::string& value) { options.skip_first = count("--skip-first", value); }},
      {"--repeat", [&](const std::string& value) { options.repeat = count("--repeat", value); }},
      {"--threads", [&](const std::string& value) { options.threads = count("--threads", value); }},
      {"--cache", [&](const std::string& value) { options.cache = value; }}};
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const auto option = known.find(arguments[i]);
    if (arguments[i] == "--stored-features") {
      options.stored_features = true;
    } else if (option != known.end() && i + 1 < arguments.size()) {
      option->second(arguments[++i]);
    } else if (arguments[i].rfind("-", 0) == 0 || !options.dataset.empty()) {
      throw ParameterError("'" + arguments[i] + "' is not understood, or lacks its value");
    } else if (isBag(arguments[i])) {
      options.bags.push_back(arguments[i]);
    } else {
      options.dataset = arguments[i];
    }
  }
  requireWhole(options);
  return options;
}

}  // namespace perennial
