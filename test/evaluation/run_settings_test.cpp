#include "perennial/evaluation/run_settings.h"

#include <gtest/gtest.h>

#include <fstream>

#include "perennial/core/error.h"
#include "perennial/testing/temporary_folder.h"

namespace perennial {
namespace {

std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "no error";
}

TEST(RunSettings, putParametersIntoTheirGroups) {
  RunSettings run("score_based");
  run.set("exchange=0.1");
  run.set("random_add=true");
  run.set("registration/ratio=0.8");
  run.set("extraction/features=300");
  run.set("map_manager/min_inliers_for_update=12");
  EXPECT_EQ(run.registration().ratio, 0.8);
  EXPECT_EQ(run.extraction().features, 300);
  EXPECT_EQ(run.learningGate().min_inliers, 12);
  RunSettings sure("score_based");
  sure.set("map_manager/min_confidence_for_update=0.9");
  EXPECT_EQ(sure.learningGate().min_confidence, 0.9);
  ParameterReader reader = run.strategyReader();
  EXPECT_EQ(reader.real("exchange", 0.0, 0.0, 1.0), 0.1);
  EXPECT_TRUE(reader.boolean("random_add", false));
  EXPECT_NO_THROW(reader.requireAllUsed());
  EXPECT_EQ(run.name(),
            "score_based,exchange=0.1,extraction.features=300,map_manager.min_inliers_for_update=12,random_"
            "add=true,"
            "registration.ratio=0.8");
}

TEST(RunSettings, readValuesOfEveryKind) {
  RunSettings run("x");
  run.set("a=7");
  run.set("b=-0.5");
  run.set("c=[86400, 3.5]");
  run.set("d=word");
  ParameterReader reader = run.strategyReader();
  EXPECT_EQ(reader.integer("a", 0, 0, 10), 7);
  EXPECT_EQ(reader.real("b", 0.0, -1.0, 1.0), -0.5);
  EXPECT_EQ(reader.reals("c", {}, 0.0, 1e9), (std::vector<double>{86400.0, 3.5}));
  EXPECT_EQ(reader.text("d", ""), "word");
}

TEST(RunSettings, refuseMistakes) {
  RunSettings run("x");
  EXPECT_THROW(run.set("novalue"), ParameterError);
  EXPECT_THROW(run.set("=5"), ParameterError);
  EXPECT_THROW(run.set("a=[1, b]"), ParameterError);
  EXPECT_NE(messageOf([&] { run.set("regestration/ratio=0.8"); }).find("regestration"), std::string::npos);
  run.set("registration/raito=0.8");
  EXPECT_NE(messageOf([&] { run.registration(); }).find("registration/raito"), std::string::npos);
}

class Sweep : public ::testing::Test {
 protected:
  std::vector<RunSettings> load(const std::string& content, const std::vector<std::string>& common = {}) {
    std::ofstream(folder_ / "sweep.yaml") << content;
    return loadSweep(folder_ / "sweep.yaml", common);
  }

  test_tools::TemporaryFolder folder_;
};

TEST_F(Sweep, isEveryCombinationOfItsGrids) {
  const auto runs = load(R"(
runs:
  - strategy: static
  - strategy: [score_based, fremen]
    set:
      exchange: [0.05, 0.1]
      score_not_matched: [0, 0.5, 1]
)",
                         {"registration/ratio=0.8"});
  ASSERT_EQ(runs.size(), 13U);
  EXPECT_EQ(runs[0].name(), "static,registration.ratio=0.8");
  EXPECT_EQ(runs[1].name(), "score_based,exchange=0.05,registration.ratio=0.8,score_not_matched=0");
  EXPECT_EQ(runs[12].name(), "fremen,exchange=0.1,registration.ratio=0.8,score_not_matched=1");
}

TEST_F(Sweep, shippedOnesAreValid) {
  EXPECT_EQ(loadSweep(std::string(SWEEPS) + "/strategies.yaml", {}).size(), 9U);
  EXPECT_EQ(loadSweep(std::string(SWEEPS) + "/strategies_as_published.yaml", {}).size(), 9U);
  EXPECT_EQ(loadSweep(std::string(SWEEPS) + "/paper_grid.yaml", {}).size(), 64U);
}

TEST_F(Sweep, mistakesNameTheFile) {
  for (const char* content :
       {"", "runs: 5", "runs:\n  - set: {a: 1}", "runs:\n  - strategy: x\n    sett: {a: 1}", "runs: [",
        "runs:\n  - strategy: x\n    set: {other/a: 1}"}) {
    EXPECT_NE(messageOf([&] { load(content); }).find("sweep.yaml"), std::string::npos) << content;
  }
}

}  // namespace
}  // namespace perennial
