#include "perennial/evaluation/paired_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "perennial/core/error.h"
#include "perennial/testing/temporary_folder.h"

namespace perennial {
namespace {

const double kMissing = std::numeric_limits<double>::quiet_NaN();

RunErrors run(const std::string& name, const std::vector<double>& errors) {
  RunErrors result;
  result.name = name;
  result.errors_px = errors;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    result.keys.push_back("t" + std::to_string(i));
  }
  return result;
}

TEST(PairedTest, agreesWithATextbookExample) {
  // Student's sleep data (Biometrika 1908): mean difference -1.58, t = -4.0621, 9 degrees of freedom, p =
  // 0.002833, 95 % interval -2.4599 .. -0.7001.
  const auto comparison = comparePaired(run("a", {0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0}),
                                        run("b", {1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4}));
  EXPECT_EQ(comparison.pairs, 10U);
  EXPECT_NEAR(comparison.mean_difference_px, -1.58, 1e-12);
  EXPECT_NEAR(comparison.t, -4.0621, 1e-4);
  EXPECT_NEAR(comparison.p, 0.002833, 1e-6);
  EXPECT_NEAR(comparison.low_px, -2.4599, 1e-4);
  EXPECT_NEAR(comparison.high_px, -0.7001, 1e-4);
}

TEST(PairedTest, countsWhatIsMissing) {
  RunErrors a = run("a", {1.0, kMissing, 3.0, kMissing, 5.0, 6.0});
  RunErrors b = run("b", {2.0, 2.0, kMissing, kMissing, 5.5, 9.0});
  b.keys[5] = "somewhere else";
  const auto comparison = comparePaired(a, b);
  EXPECT_EQ(comparison.pairs, 2U);
  EXPECT_EQ(comparison.missing_a, 1U);
  EXPECT_EQ(comparison.missing_b, 1U);
  EXPECT_EQ(comparison.missing_both, 3U) << "neither, and one each without a counterpart";
  EXPECT_NEAR(comparison.mean_difference_px, -0.75, 1e-12);
}

TEST(PairedTest, copesWithTooLittle) {
  EXPECT_EQ(comparePaired(run("a", {}), run("b", {})).p, 1.0);
  EXPECT_EQ(comparePaired(run("a", {1.0}), run("b", {2.0})).p, 1.0);
  EXPECT_EQ(comparePaired(run("a", {1.0, 1.0}), run("b", {1.0, 1.0})).p, 1.0);
  EXPECT_EQ(comparePaired(run("a", {1.0, 1.0}), run("b", {2.0, 2.0})).p, 0.0);
}

TEST(PairedTest, holmStepsDown) {
  // Holm 1979: 0.01 * 4, 0.013 * 3 but not below the one before, 0.03 * 2, 0.04.
  const auto corrected = holmCorrected({0.03, 0.01, 0.04, 0.013});
  EXPECT_NEAR(corrected[1], 0.04, 1e-12);
  EXPECT_NEAR(corrected[3], 0.04, 1e-12);
  EXPECT_NEAR(corrected[0], 0.06, 1e-12);
  EXPECT_NEAR(corrected[2], 0.06, 1e-12);
  EXPECT_EQ(holmCorrected({0.9, 0.8}), (std::vector<double>{1.0, 1.0}));
}

TEST(PairedTest, comparesEveryPairOfRuns) {
  const auto comparisons = compareAll({run("a", {1, 2, 3}), run("b", {2, 2, 5}), run("c", {9, 9, 8})});
  ASSERT_EQ(comparisons.size(), 3U);
  EXPECT_EQ(comparisons[1].a + comparisons[1].b, "ac");
  for (const PairedComparison& comparison : comparisons) {
    EXPECT_GE(comparison.p_holm, comparison.p);
  }
}

TEST(PairedTest, readsErrorsOfARun) {
  const test_tools::TemporaryFolder folder;
  std::ofstream(folder / "errors.csv") << "traversal,distance_m,error_px\na,1,-2.5\nb,1,\n";
  const RunErrors errors = loadRunErrors(folder.path(), "x");
  ASSERT_EQ(errors.errors_px.size(), 2U);
  EXPECT_EQ(errors.errors_px[0], 2.5);
  EXPECT_TRUE(std::isnan(errors.errors_px[1]));
  EXPECT_NE(errors.keys[0], errors.keys[1]);
  EXPECT_THROW(loadRunErrors(folder / "nowhere", "x"), DatasetError);
}

}  // namespace
}  // namespace perennial
