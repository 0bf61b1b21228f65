#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "perennial/core/error.h"
#include "perennial/core/local_map.h"
#include "perennial/core/map_file.h"
#include "perennial/core/map_strategy.h"
#include "perennial/core/parameter_reader.h"
#include "perennial/testing/synthetic_place.h"
#include "perennial/testing/temporary_folder.h"

/// What every map strategy must hold to, as a gtest suite to run over your own. Include this header in
/// exactly one source of a test that links gtest and perennial_core, and say what is to be tested:
///
///     #include "perennial/testing/strategy_conformance.h"
///
///     using perennial::test_tools::StrategyConformance;
///     using perennial::test_tools::strategyUnderTest;
///     INSTANTIATE_TEST_SUITE_P(Mine, StrategyConformance,
///                              testing::Values(strategyUnderTest<MyStrategy>(),
///                                              strategyUnderTest<MyStrategy>({{"exchange", 0.5}})));
///
/// It teaches local maps of synthetic places, lets the strategy learn from up to a thousand traversals by day
/// and by night, and checks what the rest of the system relies on. Everything is seeded: a failure repeats.
namespace perennial::test_tools {

struct StrategyUnderTest {
  std::function<std::shared_ptr<MapStrategy>()> create;  ///< a new instance, not configured
  Parameters parameters;                                 ///< what it is configured with
};

/// How gtest shows it.
inline void PrintTo(const StrategyUnderTest& tested, std::ostream* stream) {
  *stream << tested.create()->name() << " with " << tested.parameters.size() << " parameters set";
}

template <typename Strategy>
StrategyUnderTest strategyUnderTest(Parameters parameters = {}) {
  return {[] { return std::make_shared<Strategy>(); }, std::move(parameters)};
}

class StrategyConformance : public ::testing::TestWithParam<StrategyUnderTest> {
 protected:
  static constexpr std::size_t kTaught = 60;
  static constexpr std::size_t kSeen = 80;
  static constexpr double kStart = 1.6e9;

  std::shared_ptr<MapStrategy> create() const {
    auto strategy = GetParam().create();
    ParameterReader reader(GetParam().parameters);
    strategy->configure(reader);
    reader.requireAllUsed();
    return strategy;
  }

  /// What the map manager does before a strategy sees a local map.
  static void adopt(LocalMap& map, const MapStrategy& strategy) {
    map.adopt(numbersOwner(strategy), strategy.numbersPerFeature());
  }

  static Observation nextObservation(const MapStrategy& strategy, const LocalMap& map, SyntheticPlace& place,
                                     double stamp_s) {
    const double dx = place.uniform(-60.0, 60.0);
    return observe(strategy, map, place.view(stamp_s, dx, kSeen), stamp_s);
  }

  /// Irregular times, some three a day.
  static double nextStamp(SyntheticPlace& place, double stamp_s) {
    return stamp_s + place.uniform(60.0, 57600.0);
  }

  static void expectValidAlternatives(const MapStrategy& strategy, const LocalMap& map, double stamp_s) {
    const Alternatives alternatives = strategy.alternatives(map, stamp_s);
    ASSERT_FALSE(alternatives.empty()) << "there must be one at least, be it empty";
    for (const std::vector<std::size_t>& used : alternatives) {
      ASSERT_TRUE(std::is_sorted(used.begin(), used.end(), std::less_equal<>())) << "not strictly ascending";
      ASSERT_TRUE(used.empty() || used.back() < map.size())
          << "uses feature " << used.back() << " of " << map.size();
    }
  }

  /// Stores a map of one place that was just taught.
  static void write(const std::string& file, const LocalMap& map) {
    MapMetadata metadata;
    metadata.name = "conformance";
    metadata.image_width = 16;
    metadata.image_height = 8;
    metadata.image_encoding = "mono8";
    metadata.extraction = "synthetic";
    metadata.map_interval_m = 0.2;
    metadata.taught_stamp_s = map.stamp_s;
    MapWriter writer(file, metadata, false);
    writer.add(map, cv::Mat::zeros(8, 16, CV_8UC1));
    PathProfile profile;
    profile.add(0.0, {0.5, 0.0, 0.0});
    writer.finish(profile, 1.0);
  }

  /// One traversal of a stored map, as the map manager does it.
  void traverse(MapFile& file, SyntheticPlace& place, double stamp_s) const {
    const auto strategy = create();
    LocalMap map = file.read(0);
    adopt(map, *strategy);
    const Observation observation = nextObservation(*strategy, map, place, stamp_s);
    file.beginTraversal(numbersOwner(*strategy), stamp_s);
    if (observation.registration.displacement_px) {
      strategy->update(map, observation);
      file.stage(map);
    }
    file.commitTraversal(stamp_s);
  }

  static void expectSame(const LocalMap& a, const LocalMap& b) {
    ASSERT_EQ(a.ids, b.ids);
    ASSERT_TRUE(a.features == b.features);
    ASSERT_EQ(a.numbers, b.numbers);
    ASSERT_EQ(a.map_numbers, b.map_numbers);
    ASSERT_EQ(a.next_id, b.next_id);
    ASSERT_EQ(a.strategy, b.strategy);
  }

  /// Checks an update by what was there before: surviving features keep identity and descriptor, identities
  /// are never given out again, new features were in the view, and nothing but features and numbers changes.
  static void expectContinuity(const LocalMap& before, const LocalMap& after, const FeatureSet& view) {
    ASSERT_EQ(after.problem(), "");
    ASSERT_EQ(after.strategy, before.strategy) << "the numbers' owner must stay";
    ASSERT_EQ(after.numbers_per_feature, before.numbers_per_feature);
    ASSERT_EQ(after.index, before.index);
    ASSERT_EQ(after.distance_m, before.distance_m);
    ASSERT_EQ(after.stamp_s, before.stamp_s);
    ASSERT_GE(after.next_id, before.next_id);
    for (std::size_t i = 0; i < after.size(); ++i) {
      const Descriptor& descriptor = after.features.descriptors[i];
      if (after.ids[i] >= before.next_id) {
        ASSERT_TRUE(contains(view.descriptors, descriptor)) << "new feature " << i << " is not from the view";
        continue;
      }
      const auto old = std::find(before.ids.begin(), before.ids.end(), after.ids[i]);
      ASSERT_NE(old, before.ids.end()) << "identity " << after.ids[i] << " was dropped before and came back";
      ASSERT_TRUE(before.features.descriptors[static_cast<std::size_t>(old - before.ids.begin())] ==
                  descriptor)
          << "feature " << after.ids[i] << " changed its descriptor";
    }
  }

 private:
  static bool contains(const std::vector<Descriptor>& descriptors, const Descriptor& descriptor) {
    return std::find(descriptors.begin(), descriptors.end(), descriptor) != descriptors.end();
  }
};

TEST_P(StrategyConformance, hasANameAndAVersion) {
  const auto strategy = create();
  EXPECT_FALSE(strategy->name().empty());
  EXPECT_GE(strategy->version(), 1);
  EXPECT_EQ(numbersOwner(*strategy), numbersOwner(*create()));
  EXPECT_EQ(strategy->numbersPerFeature(), create()->numbersPerFeature());
}

TEST_P(StrategyConformance, refusesUnknownParameters) {
  Parameters parameters = GetParam().parameters;
  parameters["no_strategy_has_this_parameter"] = 1;
  ParameterReader reader(parameters);
  GetParam().create()->configure(reader);
  EXPECT_THROW(reader.requireAllUsed(), ParameterError);
}

TEST_P(StrategyConformance, keepsInvariantsOverAThousandUpdates) {
  const auto strategy = create();
  SyntheticPlace place(1);
  LocalMap map = place.teach(kStart, kTaught);
  adopt(map, *strategy);
  double stamp_s = kStart;
  int learned = 0;
  for (int traversal = 0; traversal < 1000; ++traversal) {
    SCOPED_TRACE("traversal " + std::to_string(traversal));
    stamp_s = nextStamp(place, stamp_s);
    ASSERT_NO_FATAL_FAILURE(expectValidAlternatives(*strategy, map, stamp_s));
    const Observation observation = nextObservation(*strategy, map, place, stamp_s);
    if (!observation.registration.displacement_px) {
      continue;
    }
    const LocalMap before = map;
    ASSERT_NO_THROW(strategy->update(map, observation));
    ASSERT_NO_FATAL_FAILURE(expectContinuity(before, map, observation.view));
    ASSERT_LE(map.size(), strategy->maxFeatures(kTaught, kSeen));
    ++learned;
  }
  EXPECT_GT(learned, 500) << "the map was lost: most views could not be registered any more";
}

TEST_P(StrategyConformance, keepsInvariantsWhateverHappens) {
  // A thousand events drawn at random for each of two seeds: views of any size, empty ones, such as show
  // another place, wrong displacements, time that stands still, jumps and goes back.
  for (unsigned seed = 21; seed < 23; ++seed) {
    const auto strategy = create();
    SyntheticPlace place(seed);
    SyntheticPlace elsewhere(seed + 100);
    LocalMap map = place.teach(kStart, kTaught);
    adopt(map, *strategy);
    double stamp_s = kStart;
    for (int event = 0; event < 1000; ++event) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", event " + std::to_string(event));
      const double kind = place.uniform(0.0, 1.0);
      stamp_s += kind < 0.1 ? 0.0 : kind < 0.2 ? place.uniform(-1e7, 1e7) : place.uniform(60.0, 57600.0);
      const auto seen =
          static_cast<std::size_t>(place.uniform(0.0, 1.0) < 0.1 ? 0.0 : place.uniform(1.0, kSeen));
      const double dx = place.uniform(-60.0, 60.0);
      SyntheticPlace& visited = kind > 0.9 ? elsewhere : place;
      ASSERT_NO_FATAL_FAILURE(expectValidAlternatives(*strategy, map, stamp_s));
      Observation observation = observe(*strategy, map, visited.view(stamp_s, dx, seen), stamp_s);
      if (!observation.registration.displacement_px && kind < 0.5) {
        continue;
      }
      // A wrong answer is one too.
      observation.registration.displacement_px =
          observation.registration.displacement_px.value_or(place.uniform(-300.0, 300.0));
      const LocalMap before = map;
      ASSERT_NO_THROW(strategy->update(map, observation));
      ASSERT_NO_FATAL_FAILURE(expectContinuity(before, map, observation.view));
      ASSERT_LE(map.size(), strategy->maxFeatures(kTaught, kSeen));
      ASSERT_FALSE(map.features.empty()) << "a map without features is lost for ever";
    }
  }
}

TEST_P(StrategyConformance, isDeterministicAndKeepsItsStateInTheMap) {
  // One instance works through all traversals; a new one takes over from a copy of the map at each of them,
  // as after saving, a restart and loading.
  const auto strategy = create();
  SyntheticPlace place(2);
  LocalMap map = place.teach(kStart, kTaught);
  adopt(map, *strategy);
  double stamp_s = kStart;
  for (int traversal = 0; traversal < 100; ++traversal) {
    SCOPED_TRACE("traversal " + std::to_string(traversal));
    stamp_s = nextStamp(place, stamp_s);
    const auto successor = create();
    LocalMap copy = map;
    adopt(copy, *successor);
    ASSERT_NO_FATAL_FAILURE(expectSame(map, copy)) << "its own numbers must not count as foreign";
    ASSERT_EQ(strategy->alternatives(map, stamp_s), successor->alternatives(copy, stamp_s));
    const Observation observation = nextObservation(*strategy, map, place, stamp_s);
    if (observation.registration.displacement_px) {
      strategy->update(map, observation);
      successor->update(copy, observation);
      ASSERT_NO_FATAL_FAILURE(expectSame(map, copy));
    }
  }
}

TEST_P(StrategyConformance, survivesSavingLoadingAndRollback) {
  const TemporaryFolder folder;
  SyntheticPlace place(7);
  LocalMap taught = place.teach(kStart, kTaught);
  taught.index = 0;
  write(folder / "map", taught);
  double stamp_s = kStart;
  std::vector<LocalMap> states;  // after each traversal that was stored
  for (int traversal = 0; traversal < 12; ++traversal) {
    stamp_s = nextStamp(place, stamp_s);
    {
      MapFile file(folder / "map");
      traverse(file, place, stamp_s);
      states.resize(file.traversals().size(), taught);
      states.back() = file.read(0);
    }
    ASSERT_NO_FATAL_FAILURE(expectSame(MapFile(folder / "map").read(0), states.back()))
        << "after closing the file";
    ASSERT_EQ(states.back().problem(), "");
  }
  if (states.size() < 4) {
    return;  // learned too little to roll anything back
  }
  MapFile file(folder / "map");
  const auto middle = file.traversals()[states.size() / 2];
  file.rollback(middle.id);
  ASSERT_NO_FATAL_FAILURE(expectSame(file.read(0), states[states.size() / 2]));
  traverse(file, place, stamp_s + 3600.0);
  EXPECT_EQ(file.read(0).problem(), "") << "learning goes on from there";
}

TEST_P(StrategyConformance, losesNothingOnAnEmptyView) {
  const auto strategy = create();
  SyntheticPlace place(3);
  LocalMap map = place.teach(kStart, kTaught);
  adopt(map, *strategy);
  double stamp_s = kStart;
  for (int traversal = 0; traversal < 20; ++traversal) {
    stamp_s = nextStamp(place, stamp_s);
    const Observation seen = nextObservation(*strategy, map, place, stamp_s);
    if (seen.registration.displacement_px) {
      strategy->update(map, seen);
    }
    stamp_s = nextStamp(place, stamp_s);
    Observation nothing = observe(*strategy, map, FeatureSet(), stamp_s);
    nothing.registration.displacement_px = 0.0;
    const LocalMap before = map;
    ASSERT_NO_THROW(strategy->update(map, nothing));
    ASSERT_NO_FATAL_FAILURE(expectContinuity(before, map, nothing.view));
    ASSERT_EQ(map.ids, before.ids) << "after traversal " << traversal;
  }
}

TEST_P(StrategyConformance, copesWithMapsOfAnySize) {
  const auto strategy = create();
  for (const std::size_t taught : {0U, 1U, 2U, 19U, 200U}) {
    SCOPED_TRACE("taught " + std::to_string(taught));
    SyntheticPlace place(4);
    LocalMap map = place.teach(kStart, taught);
    adopt(map, *strategy);
    for (const std::size_t seen : {1U, 2U, 30U, 200U}) {
      ASSERT_NO_FATAL_FAILURE(expectValidAlternatives(*strategy, map, kStart));
      Observation observation = observe(*strategy, map, place.view(kStart, 5.0, seen), kStart + double(seen));
      observation.registration.displacement_px = -5.0;
      const LocalMap before = map;
      ASSERT_NO_THROW(strategy->update(map, observation));
      ASSERT_NO_FATAL_FAILURE(expectContinuity(before, map, observation.view));
      ASSERT_LE(map.size(), strategy->maxFeatures(taught, 200));
    }
  }
}

TEST_P(StrategyConformance, copesWithTimesOfAnyOrder) {
  const auto strategy = create();
  SyntheticPlace place(5);
  LocalMap map = place.teach(kStart, kTaught);
  adopt(map, *strategy);
  for (const double offset_s : {0.0, 0.0, 3600.0, -86400.0, 3.2e7, 0.0, -1.6e9, 3.0e8, 0.5}) {
    const double stamp_s = kStart + offset_s;
    ASSERT_NO_FATAL_FAILURE(expectValidAlternatives(*strategy, map, stamp_s));
    Observation observation = nextObservation(*strategy, map, place, stamp_s);
    if (!observation.registration.displacement_px) {
      continue;
    }
    const LocalMap before = map;
    ASSERT_NO_THROW(strategy->update(map, observation));
    ASSERT_NO_FATAL_FAILURE(expectContinuity(before, map, observation.view)) << "at " << offset_s << " s";
  }
}

TEST_P(StrategyConformance, takesMapsOverFromOtherStrategies) {
  const auto strategy = create();
  SyntheticPlace place(6);
  LocalMap map = place.teach(kStart, kTaught);
  map.adopt("somebody_else/7", 5);
  std::fill(map.numbers.begin(), map.numbers.end(), 1e9);
  map.map_numbers = {-1.0, 1e300};
  const LocalMap foreign = map;
  adopt(map, *strategy);
  ASSERT_TRUE(map.features == foreign.features);

  LocalMap fresh = foreign;
  fresh.strategy.clear();
  fresh.numbers_per_feature = 0;
  fresh.numbers.clear();
  fresh.map_numbers.clear();
  adopt(fresh, *strategy);
  const double stamp_s = nextStamp(place, kStart);
  ASSERT_EQ(strategy->alternatives(map, stamp_s), strategy->alternatives(fresh, stamp_s));
  const Observation observation = nextObservation(*strategy, map, place, stamp_s);
  ASSERT_TRUE(observation.registration.displacement_px);
  strategy->update(map, observation);
  strategy->update(fresh, observation);
  expectSame(map, fresh);
}

}  // namespace perennial::test_tools
