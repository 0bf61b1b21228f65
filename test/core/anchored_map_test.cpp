// The frame of a map under "anchored": what moves, what never does, and how a wrong traversal is put right.
#include "perennial/strategies/anchored_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/strategy_scene.h"
#include "perennial/core/learning.h"
#include "perennial/strategies/latest_map.h"
#include "perennial/testing/synthetic_place.h"

namespace perennial::strategies {
namespace {

AnchoredMap configured(const Parameters& parameters) {
  AnchoredMap strategy;
  ParameterReader reader(parameters);
  strategy.configure(reader);
  reader.requireAllUsed();
  return strategy;
}

/// Features of the map as seen by a camera that the scene is displaced for by `displacement` px (x_map -
/// x_view).
struct Sighting {
  std::size_t feature;
  double displacement;
};

/// Each sighting is matched; `fresh` features like nothing in the map are seen beside them at x = 400, 401,
/// ...
Observation sees(const LocalMap& map, const std::vector<Sighting>& sightings, double measured,
                 std::size_t fresh, unsigned tag) {
  Observation observation;
  observation.stamp_s = 1000.0 * tag;
  observation.registration.displacement_px = measured;
  for (const Sighting& sighting : sightings) {
    Keypoint keypoint = map.features.keypoints[sighting.feature];
    keypoint.x = static_cast<float>(keypoint.x - sighting.displacement);
    const bool agrees = std::abs(sighting.displacement - measured) < 30.0;
    observation.used.push_back(sighting.feature);
    observation.registration.partners.push_back(static_cast<std::int32_t>(observation.view.size()));
    observation.registration.states.push_back(agrees ? FeatureState::kMatchedCorrectly
                                                     : FeatureState::kMatchedIncorrectly);
    observation.registration.inliers += agrees ? 1 : 0;
    observation.view.add(keypoint, map.features.descriptors[sighting.feature]);
  }
  for (std::size_t k = 0; k < fresh; ++k) {
    observation.view.add({static_cast<float>(400 + k), 80.0F, 2.0F, 0.1F},
                         descriptorNumber(1000 * tag + static_cast<unsigned>(k)));
  }
  return observation;
}

/// How far from where the camera saw it the first of these fresh features was put into the map.
double shiftOfFresh(const LocalMap& map, unsigned tag) {
  const auto& descriptors = map.features.descriptors;
  const auto found = std::find(descriptors.begin(), descriptors.end(), descriptorNumber(1000 * tag));
  return found == descriptors.end()
             ? std::nan("")
             : map.features.keypoints[static_cast<std::size_t>(found - descriptors.begin())].x - 400.0;
}

std::vector<Sighting> range(std::size_t begin, std::size_t end, double displacement) {
  std::vector<Sighting> sightings;
  for (std::size_t i = begin; i < end; ++i) {
    sightings.push_back({i, displacement});
  }
  return sightings;
}

std::vector<Sighting> both(std::vector<Sighting> a, const std::vector<Sighting>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(AnchoredMap, insertsByItsOwnEstimateAndNeverMovesTheTaught) {
  const AnchoredMap strategy = configured({{"share", 1.0}});
  LocalMap map = mapFor(strategy, 10);
  const std::vector<Keypoint> taught = map.features.keypoints;
  // The registration measured 15 px; the features say 10.
  strategy.update(map, sees(map, range(0, 10, 10.0), 15.0, 8, 1));
  ASSERT_EQ(map.size(), 18U);
  EXPECT_NEAR(shiftOfFresh(map, 1), 10.0, 1e-3);
  strategy.update(map, sees(map, both(range(0, 10, 4.0), range(10, 18, 9.0)), 5.0, 0, 2));
  EXPECT_TRUE(std::equal(taught.begin(), taught.end(), map.features.keypoints.begin()));
  EXPECT_LT(shiftOfFresh(map, 1), 9.0) << "late ones move towards the taught frame";
}

TEST(AnchoredMap, putsACohortInTheWrongPlaceRight) {
  const AnchoredMap strategy = configured({{"share", 1.0}});
  LocalMap map = mapFor(strategy, 20);
  // Ten taught features are all matched wrongly, with one accord: the view enters 90 px off.
  strategy.update(map, sees(map, range(0, 10, 100.0), 100.0, 30, 1));
  ASSERT_EQ(map.size(), 50U);
  EXPECT_NEAR(shiftOfFresh(map, 1), 100.0, 1.0) << "the true displacement was 10 px";
  // Then seen together with other taught features: few, but they are the frame.
  strategy.update(map, sees(map, both(range(10, 16, 0.0), range(20, 50, 90.0)), 90.0, 0, 2));
  EXPECT_NEAR(shiftOfFresh(map, 1), 10.0, 2.0);
}

TEST(AnchoredMap, fewWrongPairsMoveNothing) {
  const AnchoredMap strategy = configured({{"share", 1.0}});
  LocalMap map = mapFor(strategy, 10);
  strategy.update(map, sees(map, range(0, 10, 0.0), 0.0, 10, 1));
  const std::vector<Keypoint> before = map.features.keypoints;
  strategy.update(map, sees(map, both(range(0, 10, 0.0), range(10, 14, 120.0)), 0.0, 0, 2));
  for (std::size_t i = 0; i < map.size(); ++i) {
    EXPECT_NEAR(map.features.keypoints[i].x, before[i].x, 1e-3) << i;
  }
}

TEST(AnchoredMap, addsNothingWhenTwoDisplacementsAreAsGood) {
  const AnchoredMap strategy = configured({{"share", 1.0}});
  LocalMap map = mapFor(strategy, 20);
  strategy.update(map, sees(map, both(range(0, 10, 0.0), range(10, 20, 100.0)), 0.0, 10, 1));
  EXPECT_EQ(map.size(), 20U);
  strategy.update(map, sees(map, both(range(0, 16, 0.0), range(16, 20, 100.0)), 0.0, 10, 2));
  EXPECT_EQ(map.size(), 30U);
}

TEST(AnchoredMap, keepsAShareOfTheTaughtForGood) {
  const AnchoredMap strategy = configured({{"share", 1.0}, {"features_kept", 30}, {"taught_share", 0.5}});
  LocalMap map = mapFor(strategy, 20);
  for (unsigned traversal = 1; traversal <= 10; ++traversal) {
    // Only the last three taught features are ever matched; the others are what all strategies would drop.
    std::vector<Sighting> sightings;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (map.ids[i] >= 17 && map.ids[i] < 20) {
        sightings.push_back({i, 5.0});
      }
    }
    strategy.update(map, sees(map, sightings, 5.0, 20, traversal));
    ASSERT_EQ(map.problem(), "");
    ASSERT_LE(map.size(), 30U);
  }
  EXPECT_EQ(std::count_if(map.ids.begin(), map.ids.end(), [](std::uint32_t id) { return id < 20; }), 10);
  for (const std::uint32_t proven : {17U, 18U, 19U}) {
    EXPECT_EQ(std::count(map.ids.begin(), map.ids.end(), proven), 1) << "the best of the taught";
  }
}

/// Greatest error of a place's displacement in the last hundred of `traversals`, by day and night, where the
/// registration is off by a pixel, always to the same side: what makes maps drift.
double errorAfterMany(const MapStrategy& strategy, int traversals) {
  test_tools::SyntheticPlace place(21);
  double stamp_s = 1.6e9;
  LocalMap map = place.teach(stamp_s, 100);
  takeOver(map, strategy);
  double worst = 0.0;
  for (int traversal = 0; traversal < traversals; ++traversal) {
    stamp_s += place.uniform(3600.0, 40000.0);
    const double dx = place.uniform(-40.0, 40.0);
    Observation observation = test_tools::observe(strategy, map, place.view(stamp_s, dx, 100), stamp_s);
    if (!observation.registration.displacement_px) {
      continue;
    }
    if (traversal >= traversals - 100) {
      worst = std::max(worst, std::abs(*observation.registration.displacement_px + dx));
    }
    *observation.registration.displacement_px += 1.0;
    learn(map, strategy, observation);
  }
  return worst;
}

TEST(AnchoredMap, doesNotDriftWhereLatestDoes) {
  EXPECT_GT(errorAfterMany(LatestMap(), 500), 100.0);
  EXPECT_LT(errorAfterMany(AnchoredMap(), 500), 2.0);
}

}  // namespace
}  // namespace perennial::strategies
