// What each strategy drops, adds, scores and uses, exactly.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/strategy_scene.h"
#include "perennial/core/error.h"
#include "perennial/strategies/aggressive_map.h"
#include "perennial/strategies/fremen_map.h"
#include "perennial/strategies/latest_map.h"
#include "perennial/strategies/multiple_maps.h"
#include "perennial/strategies/score_based.h"
#include "perennial/strategies/static_map.h"
#include "perennial/strategies/strict_map.h"
#include "perennial/strategies/summary_map.h"

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

TEST(AggressiveMap, keepsOnlyWhatWasMatchedCorrectly) {
  const AggressiveMap strategy;
  LocalMap map = mapFor(strategy, 5);
  strategy.update(map, observed(map, "+-.+-", 7));
  EXPECT_EQ(map.ids, (Ids{0, 3, 5, 6, 7})) << "as many added as dropped";
}

TEST(AggressiveMap, dropsTheIncorrectFirstWhereTheViewHasLittleNew) {
  const AggressiveMap strategy;
  LocalMap map = mapFor(strategy, 5);
  strategy.update(map, observed(map, "+..--", 3));
  EXPECT_EQ(map.ids, (Ids{0, 2, 5, 6, 7})) << "both incorrect ones and the older of the unmatched";
}

TEST(StrictMap, dropsOnlyWhatWasMatchedIncorrectly) {
  const StrictMap strategy;
  LocalMap map = mapFor(strategy, 5);
  strategy.update(map, observed(map, "+-..-", 7));
  EXPECT_EQ(map.ids, (Ids{0, 2, 3, 5, 6}));
  strategy.update(map, observed(map, "---++", 1));
  EXPECT_EQ(map.ids, (Ids{2, 3, 5, 6, 7})) << "the oldest first, as far as there is something new";
}

TEST(SummaryMap, addsAShareOfTheViewAndGrows) {
  const auto strategy = configured<SummaryMap>({{"share", 0.5}});
  LocalMap map = mapFor(strategy, 4);
  strategy.update(map, observed(map, "+-.+", 5));  // 8 features in the view
  EXPECT_EQ(map.ids, (Ids{0, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(map.featureNumbers(0)[0], 1.0);
  EXPECT_EQ(map.featureNumbers(1)[0], 0.0);
}

TEST(SummaryMap, whenFullDropsTheOldestThatNeverServed) {
  const auto strategy = configured<SummaryMap>({{"share", 1.0}, {"max_features", 5}});
  LocalMap map = mapFor(strategy, 4);
  strategy.update(map, observed(map, ".+.+", 3));
  EXPECT_EQ(map.ids, (Ids{1, 3, 4, 5, 6})) << "one fits, for two the unmatched go";
}

TEST(MultipleMaps, startsANewAlternativeWhenNoneFits) {
  const auto strategy = configured<MultipleMaps>({{"min_correct", 2}});
  LocalMap map = mapFor(strategy, 4);
  strategy.update(map, observed(map, "++..", 3));
  EXPECT_EQ(map.ids, (Ids{0, 1, 2, 3})) << "two are enough";
  strategy.update(map, observed(map, "+...", 2));
  EXPECT_EQ(map.ids, (Ids{0, 1, 2, 3, 4, 5, 6})) << "the whole view";
  EXPECT_EQ(strategy.alternatives(map, 0.0), (Alternatives{{0, 1, 2, 3}, {4, 5, 6}}));
}

TEST(MultipleMaps, replacesTheAlternativeThatDidNotServeForLongestButNeverTheTaught) {
  const auto strategy = configured<MultipleMaps>({{"min_correct", 2}, {"max_alternatives", 3}});
  LocalMap map = mapFor(strategy, 2);
  strategy.update(map, observed(map, {0, 1}, "..", 2, 1, 1000.0));
  strategy.update(map, observed(map, {0, 1}, "..", 2, 2, 2000.0));
  EXPECT_EQ(strategy.alternatives(map, 0.0), (Alternatives{{0, 1}, {2, 3}, {4, 5}}));
  strategy.update(map, observed(map, {2, 3}, "++", 0, 3, 3000.0));  // alternative 1 serves once more
  strategy.update(map, observed(map, {0, 1}, "..", 2, 4, 4000.0));
  EXPECT_EQ(map.ids, (Ids{0, 1, 2, 3, 6, 7})) << "alternative 2 gave way";
  strategy.update(map, observed(map, {0, 1}, "..", 2, 5, 5000.0));
  EXPECT_EQ(map.ids, (Ids{0, 1, 6, 7, 8, 9})) << "then alternative 1";
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

TEST(ScoreBased, canKeepMoreThanItUses) {
  const auto strategy =
      configured<ScoreBased>({{"exchange_count", 2}, {"features_kept", 6}, {"features_used", 3}});
  LocalMap map = mapFor(strategy, 4);
  strategy.update(map, observed(map, "+-.+", 4));
  EXPECT_EQ(map.ids, (Ids{0, 1, 2, 3, 4, 5})) << "grows first";
  EXPECT_EQ(strategy.alternatives(map, 0.0), (Alternatives{{0, 3, 5}}))
      << "the best, and of equal ones the newest";
  strategy.update(map, observed(map, {0, 3, 5}, "++.", 4));
  EXPECT_EQ(map.ids, (Ids{0, 3, 4, 5, 6, 7})) << "then the worst go, the oldest first";
}

TEST(FremenMap, usesThoseThatServeAtThisTime) {
  const auto strategy = configured<FremenMap>({{"exchange", 0.0}, {"features_used", 1}, {"order", 1}});
  LocalMap map = mapFor(strategy, 2);
  constexpr double kHour = 3600.0;
  for (int hour = 0; hour < 96; hour += 3) {  // feature 0 is there by day, feature 1 by night
    const bool day = hour % 24 < 12;
    strategy.update(map, observed(map, {0, 1}, day ? "+." : ".+", 0, 1, hour * kHour));
  }
  EXPECT_EQ(strategy.alternatives(map, 126.0 * kHour), (Alternatives{{0}}));
  EXPECT_EQ(strategy.alternatives(map, 138.0 * kHour), (Alternatives{{1}}));
}

TEST(FremenMap, exchangesTheWorstMeans) {
  const auto strategy =
      configured<FremenMap>({{"exchange_count", 2}, {"features_kept", 5}, {"features_used", 4}});
  LocalMap map = mapFor(strategy, 4);
  strategy.update(map, observed(map, "+-.+", 4));
  EXPECT_EQ(map.ids, (Ids{0, 2, 3, 4, 5})) << "one more fits, the one matched incorrectly goes";
  EXPECT_EQ(strategy.alternatives(map, 0.0), (Alternatives{{0, 2, 3, 4}})) << "the untried ones are newest";
}

TEST(FremenMap, beginsAnewWhenItsPeriodsChange) {
  const auto daily =
      configured<FremenMap>({{"periods_s", std::vector<double>{86400.0}}, {"features_used", 1}});
  const auto weekly =
      configured<FremenMap>({{"periods_s", std::vector<double>{604800.0}}, {"features_used", 1}});
  LocalMap map = mapFor(daily, 3);
  daily.update(map, observed(map, "+..", 0));
  EXPECT_EQ(daily.alternatives(map, 0.0), (Alternatives{{0}}));
  EXPECT_EQ(weekly.alternatives(map, 0.0), (Alternatives{{2}})) << "without a history the newest";
  weekly.update(map, observed(map, ".+.", 0));
  EXPECT_EQ(weekly.alternatives(map, 0.0), (Alternatives{{1}}));
  EXPECT_EQ(map.featureNumbers(0)[0], 1.0) << "one sample: the other history is gone";
}

TEST(RandomAdd, drawsTheSameAgainAndSomethingElseAtAnotherTime) {
  const StaticMap strategy;
  const LocalMap map = mapFor(strategy, 3);
  AddSettings settings;
  settings.random_add = true;
  const auto drawn = [&](double stamp_s) {
    return newFeatures(map, observed(map, "+..", 50, 1, stamp_s), settings);
  };
  const auto first = drawn(1000.0);
  EXPECT_EQ(first, drawn(1000.0));
  EXPECT_NE(first, drawn(2000.0));
  EXPECT_NE(first, newFeatures(map, observed(map, "+..", 50)));
  auto sorted = first;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t k = 0; k < 50; ++k) {
    EXPECT_EQ(sorted.at(k), k + 1) << "each unpaired one once";
  }
}

TEST(RandomAdd, isAnOptionOfEveryStrategyThatAddsAPart) {
  const auto differs = [](auto strategy, auto random) {
    LocalMap least_alike = mapFor(strategy, 30);
    LocalMap drawn = least_alike;
    const Observation observation = observed(least_alike, std::string(15, '+') + std::string(15, '-'), 40);
    strategy.update(least_alike, observation);
    random.update(drawn, observation);
    EXPECT_EQ(least_alike.size(), drawn.size());
    EXPECT_FALSE(least_alike.features == drawn.features) << strategy.name();
  };
  const Parameters random = {{"random_add", true}};
  differs(AggressiveMap(), configured<AggressiveMap>(random));
  differs(StrictMap(), configured<StrictMap>(random));
  differs(SummaryMap(), configured<SummaryMap>(random));
  differs(ScoreBased(), configured<ScoreBased>(random));
  differs(FremenMap(), configured<FremenMap>(random));
}

TEST(ScoreBased, refusesParametersOutOfRange) {
  EXPECT_THROW(configured<ScoreBased>({{"exchange", 1.5}}), ParameterError);
  EXPECT_THROW(configured<ScoreBased>({{"score_correct", -1.0}}), ParameterError);
}

}  // namespace
}  // namespace perennial::strategies
