// What the registration reaches on real images, where there are some: PERENNIAL_DATA names their folder. The
// figures are those of docs/registration.md; the limits leave room for a pair or two, not for a worse method.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "perennial/core/evaluation/pairs_evaluation.h"

namespace perennial {
namespace {

class RealImages : public ::testing::Test {
 protected:
  /// All pairs of a data set, every one answered; nothing where it is missing.
  static std::optional<PairsEvaluation> pairsOf(const std::string& name) {
    const char* const folder = std::getenv("PERENNIAL_DATA");
    const std::string dataset = std::string(folder != nullptr ? folder : PERENNIAL_DEFAULT_DATA) + "/" + name;
    if (!std::filesystem::exists(dataset)) {
      return std::nullopt;
    }
    PairsSettings settings;
    settings.registration.min_confidence = 0.0;
    return evaluatePairs(loadDataset(dataset), settings);
  }

  static double within35px(const PairsSummary& summary) {
    for (const auto& [threshold_px, share] : summary.within_px) {
      if (threshold_px == 35) {
        return share;
      }
    }
    return 0.0;
  }
};

TEST_F(RealImages, michiganIsRegisteredAndItsConfidenceIsRight) {
  const auto pairs = pairsOf("michigan");
  if (!pairs) {
    GTEST_SKIP() << "no data set michigan; set PERENNIAL_DATA";
  }
  const PairsSummary summary = summarisePairs(pairs->records);
  EXPECT_EQ(summary.registrations, 330U);
  EXPECT_GE(within35px(summary), 0.98);
  EXPECT_GE(summary.answered_at_99_precision, 0.95);
  double expected = 0.0;
  for (const PairRecord& record : pairs->records) {
    expected += record.confidence;
  }
  EXPECT_NEAR(expected / 330.0, within35px(summary), 0.06) << "on the average as sure as it is right";
}

TEST_F(RealImages, summerIsRecognisedInSnow) {
  const auto pairs = pairsOf("stromovka_path");
  if (!pairs) {
    GTEST_SKIP() << "no data set stromovka_path; set PERENNIAL_DATA";
  }
  const PairsSummary summary = summarisePairs(pairs->records);
  EXPECT_EQ(summary.registrations, 40U);
  EXPECT_GE(within35px(summary), 0.9);
}

}  // namespace
}  // namespace perennial
