#include "perennial/evaluation/run_results.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <numeric>
#include <sstream>
#include <tuple>

#include "perennial/core/csv.h"
#include "perennial/core/error.h"
#include "perennial/core/utc_time.h"

namespace perennial {
namespace {

constexpr int kThresholds_px[] = {5, 10, 20, 35, 50};

std::string jsonText(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    char code[8];
    if (c == '"' || c == '\\') {
      result += std::string("\\") + c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      std::snprintf(code, sizeof(code), "\\u%04x", static_cast<unsigned char>(c));
      result += code;
    } else {
      result += c;
    }
  }
  return result + "\"";
}

/// null for NaN, which JSON does not have.
std::string number(double value) {
  if (std::isnan(value)) {
    return "null";
  }
  std::ostringstream text;
  text << std::setprecision(10) << value;
  return text.str();
}

std::string jsonNumber(const std::optional<double>& value) { return value ? number(*value) : "null"; }

/// Enough digits to read the very same number back.
std::string exact(double value) {
  std::ostringstream text;
  text << std::setprecision(17) << value;
  return text.str();
}

std::string exact(const std::optional<double>& value) { return value ? exact(*value) : ""; }

/// The lines by which a run is known, as they stand in summary.json.
std::string identity(const RunSettings& settings, const std::string& input) {
  std::string text = "  \"strategy\": " + jsonText(settings.strategy()) + ",\n  \"settings\": {";
  bool first = true;
  for (const auto& [key, value] : settings.assignments()) {
    text += std::string(first ? "" : ", ") + jsonText(key) + ": " + jsonText(value);
    first = false;
  }
  return text + "},\n  \"version\": " + jsonText(PERENNIAL_VERSION) + ",\n  \"input\": " + jsonText(input) +
         ",\n";
}

std::string summaryJson(const RunSettings& settings, const RunOutput& output) {
  const RunSummary summary = summarise(output.records);
  std::string within;
  for (const auto& [threshold, share] : summary.within_px) {
    within += (within.empty() ? "" : ", ") + jsonText(std::to_string(threshold)) + ": " + number(share);
  }
  return "{\n" + identity(settings, output.input) +                                           //
         "  \"registrations\": " + std::to_string(summary.registrations) + ",\n" +            //
         "  \"answered\": " + number(summary.answered) + ",\n" +                              //
         "  \"within_px\": {" + within + "},\n" +                                             //
         "  \"mean_error_px\": " + jsonNumber(summary.mean_error_px) + ",\n" +                //
         "  \"median_error_px\": " + jsonNumber(summary.median_error_px) + ",\n" +            //
         "  \"mean_signed_error_px\": " + jsonNumber(summary.mean_signed_error_px) + ",\n" +  //
         "  \"ms_per_registration\": " + number(summary.ms_per_registration) + ",\n" +        //
         "  \"ms_per_extraction\": " + number(output.ms_per_extraction) + "\n}\n";
}

std::string errorsCsv(const std::vector<RegistrationRecord>& records) {
  std::string text =
      "traversal,stamp,distance_m,displacement_px,ground_truth_px,error_px,inliers,matches,map_features\n";
  for (const RegistrationRecord& record : records) {
    const auto error = record.error();
    text += csvField(record.traversal) + "," + formatUtc(record.stamp_s) + "," + number(record.distance_m) +
            "," + exact(record.step.displacement_px) + "," + exact(record.ground_truth_px) + "," +
            exact(error) + "," + std::to_string(record.step.inliers) + "," +
            std::to_string(record.step.matches) + "," + std::to_string(record.step.map_features) + "\n";
  }
  return text;
}

std::string livesCsv(const FeatureLives& lives) {
  std::string text = "age_traversals,dropped,kept\n";
  const auto at = [](const std::vector<std::size_t>& counts, std::size_t age) {
    return std::to_string(age < counts.size() ? counts[age] : 0);
  };
  for (std::size_t age = 0; age < std::max(lives.dropped.size(), lives.kept.size()); ++age) {
    text += std::to_string(age) + "," + at(lives.dropped, age) + "," + at(lives.kept, age) + "\n";
  }
  return text;
}

std::string costCsv(const std::vector<RegistrationCost>& costs) {
  std::string text = "registration,places,registration_ms,learning_ms,map_features\n";
  for (std::size_t n = 0; n < costs.size(); ++n) {
    const RegistrationCost& cost = costs[n];
    text += std::to_string(n + 1) + "," + std::to_string(cost.places) + "," + number(cost.registration_ms) +
            "," + number(cost.learning_ms) + "," + number(cost.map_features) + "\n";
  }
  return text;
}

/// Whole or not at all.
void writeFile(const std::string& file, const std::string& content) {
  const std::string partial = file + ".partial";
  std::ofstream stream(partial, std::ios::binary);
  stream << content;
  stream.close();
  if (!stream || std::rename(partial.c_str(), file.c_str()) != 0) {
    throw Error(file + " cannot be written");
  }
}

}  // namespace

RunSummary summarise(const std::vector<RegistrationRecord>& records) {
  RunSummary summary;
  summary.registrations = records.size();
  std::vector<double> errors;
  double signed_sum = 0.0;
  double ms = 0.0;
  double answered = 0.0;
  double known = 0.0;
  for (const RegistrationRecord& record : records) {
    ms += record.step.registration_ms;
    answered += record.step.displacement_px ? 1.0 : 0.0;
    known += record.ground_truth_px ? 1.0 : 0.0;
    if (const auto error = record.error()) {
      errors.push_back(std::abs(*error));
      signed_sum += *error;
    }
  }
  const double all = std::max(1.0, static_cast<double>(records.size()));
  const auto judged = static_cast<double>(errors.size());
  std::sort(errors.begin(), errors.end());
  for (const int threshold : kThresholds_px) {
    const auto within = std::upper_bound(errors.begin(), errors.end(), static_cast<double>(threshold));
    summary.within_px.emplace_back(threshold,
                                   static_cast<double>(within - errors.begin()) / std::max(1.0, known));
  }
  summary.answered = answered / all;
  summary.ms_per_registration = ms / all;
  if (!errors.empty()) {
    summary.mean_error_px = std::accumulate(errors.begin(), errors.end(), 0.0) / judged;
    summary.mean_signed_error_px = signed_sum / judged;
    const std::size_t middle = errors.size() / 2;
    summary.median_error_px =
        errors.size() % 2 == 1 ? errors[middle] : 0.5 * (errors[middle - 1] + errors[middle]);
  }
  return summary;
}

std::vector<RegistrationRecord> recordsOf(const ReplayInput& input,
                                          const std::vector<PlaceReplayResult>& places,
                                          std::size_t skip_first) {
  std::vector<RegistrationRecord> records;
  for (std::size_t p = 0; p < places.size(); ++p) {
    for (std::size_t v = skip_first; v < places[p].steps.size(); ++v) {
      const DatasetRow& row = input.rows[p][v];
      records.push_back(
          {row.traversal, row.stamp_s, row.distance_m, input.groundTruth(p, v), places[p].steps[v]});
    }
  }
  std::stable_sort(records.begin(), records.end(),
                   [](const RegistrationRecord& a, const RegistrationRecord& b) {
                     return std::tie(a.traversal, a.distance_m) < std::tie(b.traversal, b.distance_m);
                   });
  return records;
}

std::vector<RegistrationCost> costsOf(const std::vector<PlaceReplayResult>& places) {
  std::vector<RegistrationCost> costs;
  for (const PlaceReplayResult& place : places) {
    costs.resize(std::max(costs.size(), place.steps.size()));
    for (std::size_t n = 0; n < place.steps.size(); ++n) {
      ++costs[n].places;
      costs[n].registration_ms += place.steps[n].registration_ms;
      costs[n].learning_ms += place.steps[n].learning_ms;
      costs[n].map_features += static_cast<double>(place.steps[n].map_features);
    }
  }
  for (RegistrationCost& cost : costs) {
    const auto count = static_cast<double>(cost.places);
    cost.registration_ms /= count;
    cost.learning_ms /= count;
    cost.map_features /= count;
  }
  return costs;
}

void writeRun(const std::string& folder, const RunSettings& settings, const RunOutput& output) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw Error("the folder " + folder + " cannot be created: " + error.message());
  }
  writeFile(folder + "/errors.csv", errorsCsv(output.records));
  writeFile(folder + "/lives.csv", livesCsv(output.lives));
  writeFile(folder + "/cost.csv", costCsv(output.costs));
  writeFile(folder + "/summary.json", summaryJson(settings, output));
}

bool isComplete(const std::string& folder, const RunSettings& settings, const std::string& input) {
  std::ifstream stream(folder + "/summary.json");
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str().find("{\n" + identity(settings, input)) == 0;
}

}  // namespace perennial
