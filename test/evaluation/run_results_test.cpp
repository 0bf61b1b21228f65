#include "perennial/evaluation/run_results.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "perennial/core/csv.h"
#include "perennial/core/error.h"
#include "perennial/testing/temporary_folder.h"

namespace perennial {
namespace {

RegistrationRecord record(const std::string& traversal, double truth, std::optional<double> found) {
  RegistrationRecord result;
  result.traversal = traversal;
  result.stamp_s = 1411795620.0;
  result.distance_m = 2.5;
  result.ground_truth_px = truth;
  result.step = {found, 12, 34, 500, 2.0};
  return result;
}

std::string contentOf(const std::string& file) {
  std::ifstream stream(file);
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

TEST(RunSummary, countsAMissingAnswerAsWrong) {
  const RunSummary summary = summarise({record("a", 10.0, 13.0), record("b", 0.0, -7.0),
                                        record("c", 5.0, std::nullopt), record("d", 0.0, 36.0)});
  EXPECT_EQ(summary.registrations, 4U);
  EXPECT_EQ(summary.answered, 0.75);
  const std::vector<std::pair<int, double>> within = {{5, 0.25}, {10, 0.5}, {20, 0.5}, {35, 0.5}, {50, 0.75}};
  EXPECT_EQ(summary.within_px, within);
  EXPECT_NEAR(*summary.mean_error_px, (3.0 + 7.0 + 36.0) / 3.0, 1e-12);
  EXPECT_EQ(*summary.median_error_px, 7.0);
  EXPECT_NEAR(*summary.mean_signed_error_px, (3.0 - 7.0 + 36.0) / 3.0, 1e-12);
  EXPECT_EQ(summary.ms_per_registration, 2.0);
}

TEST(RunSummary, judgesOnlyWhatHasAGroundTruth) {
  RegistrationRecord unknown = record("a", 0.0, 3.0);
  unknown.ground_truth_px.reset();
  EXPECT_FALSE(unknown.error());
  const RunSummary summary = summarise({unknown, record("b", 0.0, 2.0), record("c", 0.0, std::nullopt)});
  EXPECT_NEAR(summary.answered, 2.0 / 3.0, 1e-12);
  EXPECT_EQ(summary.within_px.front().second, 0.5);
  EXPECT_EQ(*summary.mean_error_px, 2.0);
}

TEST(RunSummary, hasNoMeanWithoutAnswers) {
  const RunSummary summary = summarise({record("a", 10.0, std::nullopt)});
  EXPECT_EQ(summary.answered, 0.0);
  EXPECT_FALSE(summary.mean_error_px || summary.median_error_px || summary.mean_signed_error_px);
  EXPECT_EQ(*summarise({record("a", 0.0, 1.0), record("b", 0.0, 2.0)}).median_error_px, 1.5);
}

TEST(RunOutput, costsAreMeansOverThePlaces) {
  PlaceReplayResult often;
  often.steps = {{1.0, 9, 9, 500, 1.0, 4.0}, {1.0, 9, 9, 600, 3.0, 0.0}};
  PlaceReplayResult once;
  once.steps = {{std::nullopt, 0, 0, 100, 2.0, 0.0}};
  const std::vector<RegistrationCost> costs = costsOf({often, once});
  ASSERT_EQ(costs.size(), 2U);
  EXPECT_EQ(costs[0].places, 2U);
  EXPECT_EQ(costs[0].registration_ms, 1.5);
  EXPECT_EQ(costs[0].learning_ms, 2.0);
  EXPECT_EQ(costs[0].map_features, 300.0);
  EXPECT_EQ(costs[1].places, 1U);
  EXPECT_EQ(costs[1].registration_ms, 3.0);
}

TEST(RunOutput, isReadBackExactly) {
  const test_tools::TemporaryFolder folder;
  RunSettings settings("latest");
  settings.set("registration/ratio=0.8");
  const double found = 1.0 / 3.0;
  RunOutput output{
      "some \"input\"", {record("a,b", 0.1, found), record("c", 0.0, std::nullopt)}, {{0, 3}, {5}}, {}, 4.5};
  EXPECT_FALSE(isComplete(folder / "run", settings, output.input));
  writeRun(folder / "run", settings, output);
  EXPECT_TRUE(isComplete(folder / "run", settings, output.input));
  EXPECT_FALSE(isComplete(folder / "run", settings, "another"));
  EXPECT_FALSE(isComplete(folder / "run", RunSettings("latest"), output.input));

  const CsvTable errors = CsvTable::load(folder / "run/errors.csv");
  ASSERT_EQ(errors.rows().size(), 2U);
  EXPECT_EQ(errors.text(errors.rows()[0], "traversal"), "a,b");
  EXPECT_EQ(errors.text(errors.rows()[0], "stamp"), "2014-09-27T05:27:00Z");
  EXPECT_EQ(errors.number(errors.rows()[0], "displacement_px"), found);
  EXPECT_EQ(errors.number(errors.rows()[0], "error_px"), found - 0.1);
  EXPECT_EQ(errors.number(errors.rows()[0], "map_features"), 500.0);
  EXPECT_EQ(errors.text(errors.rows()[1], "displacement_px"), "");
  EXPECT_EQ(errors.text(errors.rows()[1], "error_px"), "");
  EXPECT_EQ(contentOf(folder / "run/lives.csv"), "age_traversals,dropped,kept\n0,0,5\n1,3,0\n");

  const std::string summary = contentOf(folder / "run/summary.json");
  for (const char* key :
       {"\"strategy\": \"latest\"", "\"settings\": {\"registration/ratio\": \"0.8\"}",
        "\"version\":", "\"registrations\": 2", "\"answered\": 0.5", "\"within_px\": {\"5\": 0.5,",
        "\"mean_error_px\": 0.2333333333", "\"median_error_px\":", "\"ms_per_registration\": 2",
        "\"ms_per_extraction\": 4.5", "some \\\"input\\\""}) {
    EXPECT_NE(summary.find(key), std::string::npos) << key << " in " << summary;
  }
}

TEST(RunOutput, anUnwritableFolderIsAnError) {
  const test_tools::TemporaryFolder folder;
  std::ofstream(folder / "file") << "in the way";
  EXPECT_THROW(writeRun(folder / "file/run", RunSettings("static"), {}), Error);
}

}  // namespace
}  // namespace perennial
