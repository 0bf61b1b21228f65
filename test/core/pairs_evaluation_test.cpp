#include "perennial/core/evaluation/pairs_evaluation.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "core/features/synthetic_images.h"
#include "core/map_test_support.h"
#include "perennial/core/csv.h"
#include "perennial/core/error.h"

namespace perennial {
namespace {

/// One answer with this error and confidence; the truth is 0.
PairRecord answer(double error_px, double confidence) {
  PairRecord record;
  record.displacement_px = error_px;
  record.confidence = confidence;
  return record;
}

TEST(AnsweredAtPrecision, countsTheMostConfidentAnswers) {
  std::vector<PairRecord> records{answer(1, 0.9), answer(-35, 0.8), answer(36, 0.7), answer(2, 0.6)};
  EXPECT_DOUBLE_EQ(answeredAtPrecision(records, 0.99, 35.0), 0.5);
  EXPECT_DOUBLE_EQ(answeredAtPrecision(records, 0.75, 35.0), 1.0) << "3 of 4 are right";
  records[2].confidence = 0.95;
  EXPECT_DOUBLE_EQ(answeredAtPrecision(records, 0.99, 35.0), 0.0) << "the most confident one is wrong";
}

TEST(AnsweredAtPrecision, equalConfidenceStandsOrFallsTogether) {
  EXPECT_DOUBLE_EQ(answeredAtPrecision({answer(0, 0.5), answer(90, 0.5)}, 0.99, 35.0), 0.0);
}

TEST(AnsweredAtPrecision, silenceIsNoAnswer) {
  PairRecord silent;
  silent.confidence = 1.0;
  EXPECT_DOUBLE_EQ(answeredAtPrecision({silent, answer(0, 0.5)}, 0.99, 35.0), 0.5);
  EXPECT_DOUBLE_EQ(answeredAtPrecision({}, 0.99, 35.0), 0.0);
}

TEST(PairsSummary, countsSilenceAsWrong) {
  const PairsSummary summary = summarisePairs({answer(-4, 1), answer(8, 1), answer(40, 1), PairRecord()});
  EXPECT_DOUBLE_EQ(summary.answered, 0.75);
  const std::vector<std::pair<int, double>> within{{5, 0.25}, {10, 0.5}, {20, 0.5}, {35, 0.5}, {50, 0.75}};
  EXPECT_EQ(summary.within_px, within);
  EXPECT_DOUBLE_EQ(*summary.median_error_px, 8.0);
  EXPECT_NEAR(*summary.mean_error_px, 52.0 / 3.0, 1e-12);
  EXPECT_FALSE(summarisePairs({PairRecord()}).mean_error_px);
}

class PairsEvaluationTest : public ::testing::Test {
 protected:
  PairsEvaluationTest() {
    // Two places, three traversals: cut from a wider texture at known positions.
    std::ofstream manifest(folder_ / "manifest.csv");
    manifest << "traversal,stamp,distance_m,image,offset_px\n";
    for (int traversal = 0; traversal < 3; ++traversal) {
      for (int place = 0; place < 2; ++place) {
        const int offset = 20 * traversal * (place == 0 ? 1 : -1);
        const std::string name = std::to_string(traversal) + std::to_string(place) + ".png";
        const cv::Mat wide = texture(600, 240, static_cast<std::uint64_t>(10 + place));
        cv::imwrite(folder_ / name, wide(cv::Rect(100 - offset, 0, 400, 240)));
        manifest << "run" << traversal << ",2020-01-0" << traversal + 1 << "T00:00:00Z," << place << ","
                 << name << "," << offset << "\n";
      }
    }
  }

  TemporaryFolder folder_;
};

TEST_F(PairsEvaluationTest, registersEveryPairOfAPlaceWithTheRightSign) {
  const Dataset dataset = loadDataset(folder_ / "");
  for (const auto method : {RegistrationMethod::kHistogram, RegistrationMethod::kRobust}) {
    PairsSettings settings;
    settings.registration.method = method;
    const PairsEvaluation evaluation = evaluatePairs(dataset, settings);
    ASSERT_EQ(evaluation.records.size(), 6U);
    for (const PairRecord& record : evaluation.records) {
      EXPECT_LT(record.map.traversal, record.view.traversal);
      EXPECT_EQ(record.map.distance_m, record.view.distance_m);
      ASSERT_TRUE(record.error());
      EXPECT_NEAR(*record.error(), 0.0, 1.0);
    }
  }
}

TEST_F(PairsEvaluationTest, writesWhatOthersRead) {
  const PairsEvaluation evaluation = evaluatePairs(loadDataset(folder_ / ""), {});
  writePairs(folder_ / "out", "michigan/manifest.csv", {{"registration/ratio", "0.7"}}, evaluation);
  const CsvTable table = CsvTable::load(folder_ / "out/errors.csv");
  ASSERT_EQ(table.rows().size(), 6U);
  const CsvRow& row = table.rows().front();
  EXPECT_EQ(table.number(row, "error_px"),
            table.number(row, "displacement_px") - table.number(row, "ground_truth_px"));
  EXPECT_EQ(table.text(row, "map_traversal"), "run0");
  EXPECT_EQ(table.text(row, "traversal"), "run1");
  std::ifstream stream(folder_ / "out/summary.json");
  std::ostringstream json;
  json << stream.rdbuf();
  for (const char* key :
       {"\"settings\": {\"registration/ratio\": \"0.7\"}", "\"answered_at_99_precision\": 1",
        "\"registrations\": 6", "\"35\": 1", "\"ms_per_extraction\"", "\"version\""}) {
    EXPECT_NE(json.str().find(key), std::string::npos) << key << " in " << json.str();
  }
}

}  // namespace
}  // namespace perennial
