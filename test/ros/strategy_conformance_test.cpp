// Runs the conformance suite over every strategy that any package in the environment declares, loaded by name
// as map_manager does. Needs no roscore.
#include "perennial/testing/strategy_conformance.h"

#include <cctype>
#include <pluginlib/class_loader.hpp>

namespace perennial::test_tools {
namespace {

using StrategyLoader = pluginlib::ClassLoader<MapStrategy>;

/// Belongs to main(): it must outlive every strategy it loads, but not class_loader's own static objects.
StrategyLoader* loader = nullptr;

std::vector<std::string> declared() { return loader->getDeclaredClasses(); }

StrategyUnderTest plugin(const std::string& name) {
  return {[name] { return std::shared_ptr<MapStrategy>(loader->createUniqueInstance(name)); }, {}};
}

std::vector<StrategyUnderTest> allPlugins() {
  std::vector<StrategyUnderTest> strategies;
  for (const std::string& name : declared()) {
    strategies.push_back(plugin(name));
  }
  return strategies;
}

std::string testName(const ::testing::TestParamInfo<StrategyUnderTest>& info) {
  std::string name = declared().at(info.index);
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Plugins, StrategyConformance, ::testing::ValuesIn(allPlugins()), testName);

TEST(StrategyPlugins, areDeclared) {
  const auto names = declared();
  for (const char* name : {"static", "latest", "aggressive", "strict", "summary", "multiple", "score_based",
                           "fremen", "anchored"}) {
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  }
}

TEST(StrategyPlugins, areCalledAsTheyAreDeclared) {
  for (const std::string& name : declared()) {
    EXPECT_EQ(plugin(name).create()->name(), loader->getName(name));
  }
}

}  // namespace

int run(int argc, char** argv) {
  StrategyLoader owned("perennial_nav", "perennial::MapStrategy");
  loader = &owned;
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}

}  // namespace perennial::test_tools

int main(int argc, char** argv) { return perennial::test_tools::run(argc, argv); }
