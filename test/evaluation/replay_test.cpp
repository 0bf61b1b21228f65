#include "perennial/evaluation/replay.h"

#include <gtest/gtest.h>

#include <numeric>

#include "perennial/core/learning.h"
#include "perennial/strategies/latest_map.h"
#include "perennial/strategies/score_based.h"
#include "perennial/strategies/static_map.h"
#include "perennial/testing/synthetic_place.h"

namespace perennial {
namespace {

ReplayPlace syntheticReplay(std::size_t views) {
  test_tools::SyntheticPlace place(11);
  ReplayPlace replay;
  double stamp_s = 1.6e9;
  replay.taught = {std::make_shared<FeatureSet>(place.view(stamp_s, 0.0, 80)), stamp_s};
  for (std::size_t v = 0; v < views; ++v) {
    stamp_s += place.uniform(3600.0, 40000.0);
    replay.views.push_back(
        {std::make_shared<FeatureSet>(place.view(stamp_s, 5.0 * double(v % 7), 80)), stamp_s});
  }
  return replay;
}

TEST(Replay, isWhatTheStepsDoByHand) {
  const ReplayPlace place = syntheticReplay(30);
  const strategies::ScoreBased strategy;
  const PlaceReplayResult result = replayPlace(place, strategy, {}, {});

  LocalMap map;
  map.stamp_s = place.taught.stamp_s;
  for (std::size_t i = 0; i < place.taught.features->size(); ++i) {
    map.add(place.taught.features->keypoints[i], place.taught.features->descriptors[i]);
  }
  takeOver(map, strategy);
  ASSERT_EQ(result.steps.size(), 30U);
  for (std::size_t v = 0; v < 30; ++v) {
    const Observation observation =
        test_tools::observe(strategy, map, *place.views[v].features, place.views[v].stamp_s);
    EXPECT_EQ(result.steps[v].displacement_px, observation.registration.displacement_px);
    EXPECT_EQ(result.steps[v].inliers, observation.registration.inliers);
    EXPECT_EQ(result.steps[v].matches, observation.registration.matches);
    EXPECT_EQ(result.steps[v].map_features, map.size());
    if (observation.registration.displacement_px) {
      strategy.update(map, observation);
      EXPECT_NEAR(*observation.registration.displacement_px, -5.0 * double(v % 7), 2.0);
    }
  }
}

TEST(Replay, teachesNothingBelowTheGate) {
  const ReplayPlace place = syntheticReplay(10);
  const strategies::LatestMap strategy;
  const PlaceReplayResult untouched = replayPlace(place, strategies::StaticMap(), {}, {});
  const LearningGate too_few{1000, 0.0};
  const LearningGate unsure{1, 1.0};  // which no estimate reaches
  for (const LearningGate& gate : {too_few, unsure}) {
    const PlaceReplayResult gated = replayPlace(place, strategy, {}, gate);
    for (std::size_t v = 0; v < 10; ++v) {
      EXPECT_EQ(gated.steps[v].displacement_px, untouched.steps[v].displacement_px);
    }
    EXPECT_EQ(gated.lives.kept, untouched.lives.kept);
  }
  const PlaceReplayResult sure = replayPlace(place, strategy, {}, {1, 0.9});
  EXPECT_NE(sure.lives.dropped, untouched.lives.dropped);
}

TEST(Replay, countsHowLongFeaturesLive) {
  const ReplayPlace place = syntheticReplay(3);
  const PlaceReplayResult latest = replayPlace(place, strategies::LatestMap(), {}, {});
  for (const ReplayStep& step : latest.steps) {
    ASSERT_TRUE(step.displacement_px);
  }
  EXPECT_EQ(latest.lives.dropped, (std::vector<std::size_t>{0, 240}));
  EXPECT_EQ(latest.lives.kept, (std::vector<std::size_t>{80}));
  const PlaceReplayResult unchanged = replayPlace(place, strategies::StaticMap(), {}, {});
  EXPECT_EQ(unchanged.lives.dropped, std::vector<std::size_t>());
  EXPECT_EQ(unchanged.lives.kept, (std::vector<std::size_t>{0, 0, 0, 80}));
  FeatureLives sum = unchanged.lives;
  sum.add(latest.lives);
  EXPECT_EQ(sum.kept, (std::vector<std::size_t>{80, 0, 0, 80}));
}

}  // namespace
}  // namespace perennial
