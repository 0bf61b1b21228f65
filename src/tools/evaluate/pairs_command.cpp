#include "tools/evaluate/pairs_command.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/core/evaluation/pairs_evaluation.h"

namespace perennial {

const char kPairsUsage[] =
    R"(usage: evaluate --pairs DATASET --out DIR [--set KEY=VALUE]... [--disturb KIND=AMOUNT]

Registers every pair of images of each place, the earlier one as the map, without map management. Writes errors.csv and
summary.json to DIR.

  --set KEY=VALUE   a parameter: registration/method, registration/ratio, extraction/features, ... Unless it is set,
                    registration/min_confidence is 0 here: every answer counts, its confidence stands beside it
  --disturb KIND=AMOUNT   disturbs every view, not the maps: cover=0.3 (a passing object covers that share), blur=10 (px,
                    horizontally), roll=3, pitch=3 (degrees the camera is tilted), saturate=0.5 (that share is white)
)";

namespace {

using Assignments = std::vector<std::pair<std::string, std::string>>;

struct Options {
  std::string dataset;
  std::string out;
  Assignments assignments;
  std::optional<Disturbance> disturbance;
  std::string disturb;  ///< the same as it was given
};

std::pair<std::string, std::string> assignment(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw ParameterError("--set takes KEY=VALUE, not '" + text + "'");
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

Options parse(const std::vector<std::string>& arguments) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const bool has_value = i + 1 < arguments.size();
    if (arguments[i] == "--out" && has_value) {
      options.out = arguments[++i];
    } else if (arguments[i] == "--set" && has_value) {
      options.assignments.push_back(assignment(arguments[++i]));
    } else if (arguments[i] == "--disturb" && has_value && !options.disturbance) {
      options.disturbance = Disturbance::parse(arguments[++i]);
      options.disturb = arguments[i];
    } else if (arguments[i].rfind("-", 0) != 0 && options.dataset.empty()) {
      options.dataset = arguments[i];
    } else {
      throw ParameterError("'" + arguments[i] + "' is not understood, or lacks its value");
    }
  }
  if (options.dataset.empty() || options.out.empty()) {
    throw ParameterError("a data set and --out are needed");
  }
  return options;
}

ParameterValue valueOf(const std::string& text) {
  if (text == "true" || text == "false") {
    return text == "true";
  }
  char* end = nullptr;
  const long integer = std::strtol(text.c_str(), &end, 10);
  if (!text.empty() && *end == '\0' && integer >= -1000000000 && integer <= 1000000000) {
    return static_cast<int>(integer);
  }
  const double real = std::strtod(text.c_str(), &end);
  if (!text.empty() && *end == '\0') {
    return real;
  }
  return text;
}

/// Settings of one group, of the assignments whose keys begin with its name.
template <class Settings>
Settings loadGroup(const std::string& group, const Assignments& assignments) {
  Parameters parameters;
  for (const auto& [key, value] : assignments) {
    if (key.rfind(group + "/", 0) == 0) {
      parameters[key.substr(group.size() + 1)] = valueOf(value);
    }
  }
  ParameterReader reader(parameters, group + "/");
  Settings settings = Settings::load(reader);
  reader.requireAllUsed();
  return settings;
}

/// What keeps silent a robot that drives would hide how good the registration and its confidence are.
void answerAlways(Assignments& assignments) {
  const std::string key = "registration/min_confidence";
  const auto is_key = [&key](const auto& entry) { return entry.first == key; };
  if (std::none_of(assignments.begin(), assignments.end(), is_key)) {
    assignments.emplace_back(key, "0");
  }
}

PairsSettings settingsFrom(const Assignments& assignments) {
  for (const auto& entry : assignments) {
    if (entry.first.rfind("registration/", 0) != 0 && entry.first.rfind("extraction/", 0) != 0) {
      throw ParameterError("'" + entry.first + "' begins neither with registration/ nor with extraction/");
    }
  }
  return {loadGroup<ExtractionSettings>("extraction", assignments),
          loadGroup<RegistrationSettings>("registration", assignments), std::nullopt};
}

void print(const PairsEvaluation& evaluation) {
  const PairsSummary summary = summarisePairs(evaluation.records);
  std::printf("%zu pairs, %.1f %% answered", summary.registrations, 100.0 * summary.answered);
  for (const auto& [threshold, share] : summary.within_px) {
    std::printf(", %d px %.1f %%", threshold, 100.0 * share);
  }
  std::printf(", answered at 99 %% precision %.1f %%, %.2f ms extraction, %.2f ms registration\n",
              100.0 * summary.answered_at_99_precision, evaluation.ms_per_extraction,
              evaluation.ms_per_registration);
}

}  // namespace

int evaluatePairsCommand(const std::vector<std::string>& arguments) {
  Options options = parse(arguments);
  answerAlways(options.assignments);
  PairsSettings settings = settingsFrom(options.assignments);
  if (options.disturbance) {
    settings.disturbance = options.disturbance;
    options.assignments.emplace_back("disturb", options.disturb);
  }
  const Dataset dataset = loadDataset(options.dataset);
  const PairsEvaluation evaluation = evaluatePairs(dataset, settings);
  writePairs(options.out, dataset.manifest, options.assignments, evaluation);
  print(evaluation);
  return 0;
}

}  // namespace perennial
