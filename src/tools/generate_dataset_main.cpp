// rosrun perennial_nav generate_dataset: a long-term data set of the embedded world with exact ground truth.
#include <iostream>
#include <string>
#include <vector>

#include "perennial/core/error.h"
#include "perennial/core/utc_time.h"
#include "perennial/park/dataset_generator.h"
#include "tools/evaluate/progress.h"

namespace perennial {
namespace {

constexpr char kUsage[] =
    R"(usage: generate_dataset --out DIR [--places N] [--traversals N] [--days D] [--seed S] [--start TIME]
                        [--max-offset PX] [--position-error M]

Renders the places of a path of the embedded park through a season, at irregular times of day and night and in changing
weather. Writes PNG images and manifest.csv. Goes on where an earlier run stopped.

  --places N          places, evenly along the path (32)
  --traversals N      how often they are seen, the teaching included (178)
  --days D            that the traversals spread over (90)
  --seed S            of park, times, weather, offsets and noise (1)
  --start TIME        of the first traversal (2026-09-01T09:00:00Z)
  --max-offset PX     images are displaced by up to this much (120)
  --position-error M  standard deviation of where the robot stands (0: the displacement is exact)
)";

/// The arguments as parameters, so that ranges are checked as everywhere else.
ParameterReader reader(const std::vector<std::string>& arguments, std::string& out) {
  Parameters parameters;
  for (std::size_t i = 0; i + 1 < arguments.size(); i += 2) {
    const std::string& value = arguments[i + 1];
    if (arguments[i] == "--out") {
      out = value;
    } else if (arguments[i] == "--start") {
      parameters["--start"] = value;
    } else if (value.find_first_not_of("-0123456789") == std::string::npos && value.size() < 9) {
      parameters[arguments[i]] = std::stoi(value);
    } else {
      parameters[arguments[i]] = std::stod(value);
    }
  }
  if (arguments.size() % 2 != 0 || out.empty()) {
    throw ParameterError("--out is needed, and every option takes a value");
  }
  return ParameterReader(parameters);
}

park::GeneratedDatasetSettings load(ParameterReader& reader) {
  park::GeneratedDatasetSettings settings;
  settings.places = reader.integer("--places", settings.places, 1, 999);
  settings.traversals = reader.integer("--traversals", settings.traversals, 2, 999);
  settings.days = reader.real("--days", settings.days, 0.01, 10000.0);
  settings.seed = reader.integer("--seed", settings.seed, 0, 1000000);
  settings.max_offset_px = reader.integer("--max-offset", settings.max_offset_px, 0, 300);
  settings.position_error_m = reader.real("--position-error", settings.position_error_m, 0.0, 1.0);
  const std::string start = reader.text("--start", formatUtc(settings.start_s));
  const auto stamp = parseUtc(start);
  if (!stamp) {
    throw ParameterError("--start is '" + start + "', not a time like 2026-09-01T09:00:00Z");
  }
  settings.start_s = *stamp;
  reader.requireAllUsed();
  return settings;
}

}  // namespace
}  // namespace perennial

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    if (arguments.empty() || arguments[0] == "--help") {
      std::cout << perennial::kUsage;
      return arguments.empty() ? 2 : 0;
    }
    std::string out;
    perennial::ParameterReader reader = perennial::reader(arguments, out);
    const auto settings = perennial::load(reader);
    perennial::Progress progress("traversals", static_cast<std::size_t>(settings.traversals));
    perennial::park::generateDataset(out, settings, [&](std::size_t done) { progress.show(done); });
    return 0;
  } catch (const std::invalid_argument&) {
    std::cerr << "generate_dataset: a value is not a number; see --help\n";
  } catch (const std::exception& error) {
    std::cerr << "generate_dataset: " << error.what() << "\n";
  }
  return 1;
}
