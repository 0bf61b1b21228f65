#include "perennial/core/map_update.h"

#include <gtest/gtest.h>

#include "core/strategy_scene.h"
#include "perennial/strategies/static_map.h"

namespace perennial {
namespace {

/// Descriptor of map feature 0 with this many bits changed.
Descriptor unlikeFeature0(int bits) {
  Descriptor descriptor = descriptorNumber(0);
  for (int bit = 0; bit < bits; ++bit) {
    descriptor.words[static_cast<std::size_t>(bit / 64)] ^= std::uint64_t{1} << (bit % 64);
  }
  return descriptor;
}

TEST(NewFeatures, areTheUnpairedOnesLeastLikeTheMapFirst) {
  const LocalMap map = mapFor(strategies::StaticMap(), 3);
  Observation observation = observed(map, "+-.", 0);
  ASSERT_EQ(observation.view.size(), 2U) << "both paired";
  for (const int bits : {10, 40, 40, 25}) {
    observation.view.add({300.0F, 50.0F, 2.0F, 0.1F}, unlikeFeature0(bits));
  }
  EXPECT_EQ(newFeatures(map, observation), (std::vector<std::size_t>{3, 4, 5, 2}));
}

TEST(NewFeatures, areComparedWithUnusedMapFeaturesToo) {
  const LocalMap map = mapFor(strategies::StaticMap(), 3);
  Observation observation = observed(map, {1, 2}, "..", 1);
  observation.view.add({300.0F, 50.0F, 2.0F, 0.1F}, unlikeFeature0(5));
  EXPECT_EQ(newFeatures(map, observation), (std::vector<std::size_t>{0, 1}));
}

TEST(NewFeatures, ofAnEmptyMapAreAllOfTheView) {
  LocalMap map;
  EXPECT_EQ(newFeatures(map, observed(map, "", 3)), (std::vector<std::size_t>{0, 1, 2}));
}

TEST(InsertFromView, putsFeaturesIntoTheMapsFrame) {
  LocalMap map = mapFor(strategies::StaticMap(), 1);
  const Observation observation = observed(map, "+", 2);
  insertFromView(map, observation, {2});
  ASSERT_EQ(map.size(), 2U);
  EXPECT_EQ(map.features.keypoints[1].x, 401.0F + 10.0F) << "x_map = x_view + displacement";
  EXPECT_EQ(map.features.keypoints[1].y, 80.0F);
  EXPECT_EQ(map.features.descriptors[1], observation.view.descriptors[2]);
  EXPECT_EQ(map.problem(), "");
}

}  // namespace
}  // namespace perennial
