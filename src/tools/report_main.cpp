// rosrun perennial_nav report: compares runs of `evaluate`. The statistics are made here, the plots and the
// page by scripts/plot_report.py.
#include <ros/package.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "perennial/core/csv.h"
#include "perennial/core/error.h"
#include "perennial/evaluation/paired_test.h"

namespace perennial {
namespace {

constexpr char kUsage[] = R"(usage: report RUN... --out DIR [--site LATITUDE,LONGITUDE]

Compares runs of `evaluate`, with strategies or --pairs: folders with errors.csv and summary.json, or folders of such folders.
Writes report.html, which holds everything, and the figures beside it as PNG and SVG, the tables as CSV; of pairs also how
reliable the confidence is. The site, in degrees north and east,
is where the images were taken: day and night go by the sun's elevation there. Default: that of the embedded park, 50,14.4.
)";

struct Options {
  std::vector<std::string> folders;
  std::string out;
  std::string latitude_deg = "50.0";  // of the park
  std::string longitude_deg = "14.4";
};

std::string degrees(const std::string& text, double most) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(std::abs(value) <= most)) {
    throw ParameterError("--site takes LATITUDE,LONGITUDE in degrees; '" + text + "' is none");
  }
  return text;
}

Options parse(const std::vector<std::string>& arguments) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--out" && i + 1 < arguments.size()) {
      options.out = arguments[++i];
    } else if (arguments[i] == "--site" && i + 1 < arguments.size()) {
      const std::string& site = arguments[++i];
      const std::size_t comma = std::min(site.find(','), site.size());
      options.latitude_deg = degrees(site.substr(0, comma), 90.0);
      options.longitude_deg = degrees(site.substr(std::min(comma + 1, site.size())), 180.0);
    } else if (arguments[i].rfind("-", 0) == 0) {
      throw ParameterError("'" + arguments[i] + "' is not understood, or lacks its value");
    } else {
      options.folders.push_back(arguments[i]);
    }
  }
  if (options.out.empty() || options.folders.empty()) {
    throw ParameterError("at least one run and --out are needed");
  }
  return options;
}

/// Folders of complete runs among those given or directly in them, sorted within each.
std::vector<std::string> findRuns(const std::vector<std::string>& folders) {
  std::vector<std::string> runs;
  for (const std::string& folder : folders) {
    std::vector<std::string> found;
    if (std::filesystem::exists(folder + "/summary.json")) {
      found.push_back(folder);
    } else if (std::filesystem::is_directory(folder)) {
      for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (std::filesystem::exists(entry.path() / "summary.json")) {
          found.push_back(entry.path().string());
        }
      }
    }
    if (found.empty()) {
      throw DatasetError(folder + ": is no complete run and holds none (a run has a summary.json)");
    }
    std::sort(found.begin(), found.end());
    runs.insert(runs.end(), found.begin(), found.end());
  }
  return runs;
}

std::string nameOf(const std::string& run) {
  return std::filesystem::path(run + "/").parent_path().filename().string();
}

void writeComparisons(const std::string& file, const std::vector<PairedComparison>& comparisons) {
  std::ofstream stream(file);
  stream << "a,b,pairs,missing_a,missing_b,missing_both,mean_difference_px,low_px,high_px,t,p,p_holm\n"
         << std::setprecision(6);
  for (const PairedComparison& c : comparisons) {
    stream << csvField(c.a) << "," << csvField(c.b) << "," << c.pairs << "," << c.missing_a << ","
           << c.missing_b << "," << c.missing_both << "," << c.mean_difference_px << "," << c.low_px << ","
           << c.high_px << "," << c.t << "," << c.p << "," << c.p_holm << "\n";
  }
  stream.close();
  if (!stream) {
    throw Error(file + " cannot be written");
  }
}

/// Replaces this process by the one that plots.
[[noreturn]] void plot(const Options& options, const std::vector<std::string>& runs) {
  const std::string script = ros::package::getPath("perennial_nav") + "/scripts/plot_report.py";
  std::vector<std::string> words = {"/usr/bin/python3", script, options.out, options.latitude_deg,
                                    options.longitude_deg};
  words.insert(words.end(), runs.begin(), runs.end());
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  execv(arguments[0], arguments.data());
  throw Error(words[0] + " cannot be started");
}

void report(const Options& options) {
  const std::vector<std::string> folders = findRuns(options.folders);
  std::vector<RunErrors> runs;
  for (const std::string& folder : folders) {
    runs.push_back(loadRunErrors(folder, nameOf(folder)));
  }
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  writeComparisons(options.out + "/comparisons.csv", compareAll(runs));
  plot(options, folders);
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
    perennial::report(perennial::parse(arguments));
  } catch (const std::exception& error) {
    std::cerr << "report: " << error.what() << "\n";
  }
  return 1;
}
