#include "perennial_example_strategy/oldest_first.h"

#include <gtest/gtest.h>
#include <perennial/testing/strategy_conformance.h>

#include <pluginlib/class_loader.hpp>

namespace perennial_example_strategy {
namespace {

using perennial::test_tools::StrategyConformance;
using perennial::test_tools::strategyUnderTest;

// What every strategy must hold to.
INSTANTIATE_TEST_SUITE_P(OldestFirst, StrategyConformance,
                         ::testing::Values(strategyUnderTest<OldestFirst>(),
                                           strategyUnderTest<OldestFirst>({{"exchange", 1.0}})));

// What is special to this one.
TEST(OldestFirst, keepsWhatWasSeen) {
  OldestFirst strategy;
  perennial::ParameterReader reader({{"exchange", 0.5}});
  strategy.configure(reader);
  perennial::test_tools::SyntheticPlace place(1);
  perennial::LocalMap map = place.teach(1000.0, 40);
  map.adopt(perennial::numbersOwner(strategy), strategy.numbersPerFeature());

  const double night_s = 50000.0;
  const perennial::Observation seen =
      perennial::test_tools::observe(strategy, map, place.view(night_s, 8.0, 60), night_s);
  ASSERT_TRUE(seen.registration.displacement_px);
  ASSERT_GT(seen.registration.inliers, 5);
  ASSERT_LE(seen.registration.inliers, 20) << "so that all of them fit into the half that stays";
  const perennial::LocalMap before = map;
  strategy.update(map, seen);
  EXPECT_EQ(map.size(), before.size());
  EXPECT_EQ(map.next_id, before.next_id + 20) << "half of the features are new";
  for (std::size_t k = 0; k < seen.used.size(); ++k) {
    if (seen.registration.states[k] == perennial::FeatureState::kMatchedCorrectly) {
      EXPECT_EQ(std::count(map.ids.begin(), map.ids.end(), before.ids[seen.used[k]]), 1);
    }
  }
}

// What map_manager does with `strategy: oldest_first`.
TEST(OldestFirst, isLoadedByName) {
  pluginlib::ClassLoader<perennial::MapStrategy> loader("perennial_nav", "perennial::MapStrategy");
  const auto strategy = loader.createUniqueInstance("oldest_first");
  EXPECT_EQ(strategy->name(), "oldest_first");
  EXPECT_TRUE(loader.isClassAvailable("static")) << "perennial_nav's own are still there";
}

}  // namespace
}  // namespace perennial_example_strategy
