// errors.csv and summary.json of an evaluation of pairs.
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>

#include "perennial/core/csv.h"
#include "perennial/core/error.h"
#include "perennial/core/evaluation/pairs_evaluation.h"
#include "perennial/core/utc_time.h"

namespace perennial {
namespace {

/// Enough digits to read the very same number back.
std::string exact(const std::optional<double>& value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  if (value) {
    text << std::setprecision(17) << *value;
  }
  return text.str();
}

std::string number(const std::optional<double>& value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  if (value) {
    text << std::setprecision(10) << *value;
  }
  return value ? text.str() : "null";
}

std::string jsonText(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const bool control = static_cast<unsigned char>(c) < 0x20;
    result += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, control ? ' ' : c);
  }
  return result + "\"";
}

std::string errorsCsv(const std::vector<PairRecord>& records) {
  std::string text =
      "traversal,stamp,distance_m,displacement_px,ground_truth_px,error_px,inliers,matches,map_features,map_"
      "traversal,"
      "confidence,uncertainty_px\n";
  for (const PairRecord& record : records) {
    text += csvField(record.view.traversal) + "," + formatUtc(record.view.stamp_s) + "," +
            number(record.view.distance_m) + "," + exact(record.displacement_px) + "," +
            exact(record.groundTruth()) + "," + exact(record.error()) + "," + std::to_string(record.inliers) +
            "," + std::to_string(record.matches) + "," + std::to_string(record.map_features) + "," +
            csvField(record.map.traversal) + "," + exact(record.confidence) + "," +
            exact(record.uncertainty_px) + "\n";
  }
  return text;
}

std::string summaryJson(const std::string& input,
                        const std::vector<std::pair<std::string, std::string>>& settings,
                        const PairsEvaluation& evaluation) {
  const PairsSummary summary = summarisePairs(evaluation.records);
  std::string assignments;
  for (const auto& [key, value] : settings) {
    assignments += (assignments.empty() ? "" : ", ") + jsonText(key) + ": " + jsonText(value);
  }
  std::string within;
  for (const auto& [threshold, share] : summary.within_px) {
    within += (within.empty() ? "" : ", ") + jsonText(std::to_string(threshold)) + ": " + number(share);
  }
  return "{\n  \"strategy\": \"none: all pairs\",\n  \"settings\": {" + assignments + "},\n" +    //
         "  \"version\": " + jsonText(PERENNIAL_VERSION) + ",\n" +                                //
         "  \"input\": " + jsonText(input) + ",\n" +                                              //
         "  \"registrations\": " + std::to_string(summary.registrations) + ",\n" +                //
         "  \"answered\": " + number(summary.answered) + ",\n" +                                  //
         "  \"within_px\": {" + within + "},\n" +                                                 //
         "  \"answered_at_99_precision\": " + number(summary.answered_at_99_precision) + ",\n" +  //
         "  \"mean_error_px\": " + number(summary.mean_error_px) + ",\n" +                        //
         "  \"median_error_px\": " + number(summary.median_error_px) + ",\n" +                    //
         "  \"ms_per_registration\": " + number(evaluation.ms_per_registration) + ",\n" +         //
         "  \"ms_per_extraction\": " + number(evaluation.ms_per_extraction) + "\n}\n";
}

/// Whole or not at all.
void writeFile(const std::filesystem::path& file, const std::string& content) {
  const std::filesystem::path partial = file.string() + ".partial";
  std::ofstream stream(partial, std::ios::binary);
  stream << content;
  stream.close();
  std::error_code error;
  if (stream) {
    std::filesystem::rename(partial, file, error);
  }
  if (!stream || error) {
    throw Error(file.string() + " cannot be written");
  }
}

}  // namespace

void writePairs(const std::string& folder, const std::string& input,
                const std::vector<std::pair<std::string, std::string>>& settings,
                const PairsEvaluation& evaluation) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw Error("the folder " + folder + " cannot be created: " + error.message());
  }
  writeFile(std::filesystem::path(folder) / "errors.csv", errorsCsv(evaluation.records));
  writeFile(std::filesystem::path(folder) / "summary.json", summaryJson(input, settings, evaluation));
}

}  // namespace perennial
