// What each strategy drops, adds, scores and uses, exactly.
#include <gtest/gtest.h>

#include "core/strategy_scene.h"
#include "perennial/core/error.h"
#include "perennial/strategies/latest_map.h"
#include "perennial/strategies/score_based.h"
#include "perennial/strategies/static_map.h"

namespace perennial::strategies {
namespace {

template <typename Strategy>
Strategy configured(const Parameters& parameters) {
  Strategy strategy;
  ParameterReader reader(parameters);
  strategy.configure(reader);
  reader.requireAllUsed();
  return strategy;
}

TEST(StaticMap, changesNothing) {
  const StaticMap strategy;
  LocalMap map = mapFor(strategy, 4);
  strategy.update(map, observed(map, "+-..", 5));
  EXPECT_EQ(map.ids, (Ids{0, 1, 2, 3}));
  EXPECT_EQ(strategy.alternatives(map, 0.0), (Alternatives{{0, 1, 2, 3}}));
}

TEST(LatestMap, isTheWholeViewInTheMapsFrame) {
  const LatestMap strategy;
  LocalMap map = mapFor(strategy, 4);
  const Observation observation = observed(map, "++-.", 2);
  strategy.update(map, observation);
  EXPECT_EQ(map.ids, (Ids{4, 5, 6, 7, 8}));
  EXPECT_EQ(map.features.descriptors, observation.view.descriptors);
  EXPECT_EQ(map.features.keypoints[0].x, 100.0F) << "where the taught one was";
  EXPECT_EQ(map.features.keypoints[3].x, 410.0F);
}

TEST(ScoreBased, addsTheScoresOfTheOutcomes) {
  const auto strategy = configured<ScoreBased>(
      {{"exchange", 0.0}, {"score_correct", 2.0}, {"score_incorrect", 3.0}, {"score_not_matched", 0.5}});
  LocalMap map = mapFor(strategy, 4);
  strategy.update(map, observed(map, {0, 1, 3}, "+-.", 3));
  strategy.update(map, observed(map, {0, 1, 3}, "++.", 3));
  EXPECT_EQ(map.ids, (Ids{0, 1, 2, 3})) << "nothing is exchanged";
  EXPECT_EQ(map.featureNumbers(0)[0], 4.0);
  EXPECT_EQ(map.featureNumbers(1)[0], -1.0);
  EXPECT_EQ(map.featureNumbers(2)[0], 0.0) << "was not used";
  EXPECT_EQ(map.featureNumbers(3)[0], -1.0);
}

TEST(ScoreBased, exchangesTheWorst) {
  const auto strategy = configured<ScoreBased>({{"exchange", 0.4}});
  LocalMap map = mapFor(strategy, 5);
  const Observation observation = observed(map, "+--.+", 4);
  strategy.update(map, observation);
  EXPECT_EQ(map.ids, (Ids{0, 3, 4, 5, 6})) << "0.4 of 5: the two matched incorrectly";
  EXPECT_EQ(map.featureNumbers(3)[0], 0.0) << "a new feature starts at 0";
}

TEST(ScoreBased, dropsTheOldestNeverMatchedOfEqualScores) {
  const auto strategy = configured<ScoreBased>({{"exchange", 0.5}});
  LocalMap map = mapFor(strategy, 4);
  map.featureNumbers(0)[1] = 1.0;  // was matched correctly once, and incorrectly once
  strategy.update(map, observed(map, "....", 4));
  EXPECT_EQ(map.ids, (Ids{0, 3, 4, 5}));
}

TEST(ScoreBased, dropsNoMoreThanItCanReplace) {
  const auto strategy = configured<ScoreBased>({{"exchange", 0.5}});
  LocalMap map = mapFor(strategy, 4);
  strategy.update(map, observed(map, "--..", 1));
  EXPECT_EQ(map.ids, (Ids{1, 2, 3, 4}));
  strategy.update(map, observed(map, "....", 0));
  EXPECT_EQ(map.ids, (Ids{1, 2, 3, 4}));
}

TEST(ScoreBased, refusesParametersOutOfRange) {
  EXPECT_THROW(configured<ScoreBased>({{"exchange", 1.5}}), ParameterError);
  EXPECT_THROW(configured<ScoreBased>({{"score_correct", -1.0}}), ParameterError);
}

}  // namespace
}  // namespace perennial::strategies
