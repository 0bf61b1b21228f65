// A view is found among all local maps of a path; refused where nothing or too much looks like it.
#include "perennial/core/place_finder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <vector>

#include "perennial/core/error.h"
#include "perennial/core/localisation.h"
#include "perennial/testing/synthetic_place.h"

namespace perennial {
namespace {

using test_tools::SyntheticPlace;

FeatureSet featuresAt(unsigned place, double dx = 0.0, std::size_t features = 500) {
  return SyntheticPlace(place, 600).view(0.0, dx, features);
}

/// Local maps 0.2 m apart; every place, 1 m long, has landmarks of its own, unless it repeats after `period`
/// places.
using Path = std::vector<std::shared_ptr<ActiveMap>>;

Path path(unsigned local_maps, unsigned period) {
  Path maps;
  for (unsigned i = 0; i < local_maps; ++i) {
    auto map = std::make_shared<ActiveMap>();
    map->index = i;
    map->distance_m = 0.2 * i;
    map->alternatives.emplace_back();
    map->alternatives.front().features = featuresAt(i / 5 % period);
    maps.push_back(std::move(map));
  }
  return maps;
}

PlaceGuess find(const Path& maps, const FeatureSet& view, bool loop = false) {
  LocalisationSettings settings;
  settings.loop = loop;
  PlaceFinder finder(settings);
  finder.seek(view);
  for (const auto& map : maps) {
    finder.consider(map);
  }
  return finder.guess();
}

TEST(PlaceFinder, findsAPlaceAmongAThousandLocalMaps) {
  const Path maps = path(1000, 1000);
  const FeatureSet view = featuresAt(123, 40.0);
  const auto begin = std::chrono::steady_clock::now();
  const PlaceGuess guess = find(maps, view);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::printf("1000 local maps of 500 features: %.3f s, %s, certainty %.2f\n", took.count(),
              guess.reason.c_str(), guess.certainty);
  EXPECT_TRUE(guess.sure) << guess.reason;
  EXPECT_GE(guess.distance_m, 123.0 - 1e-9);
  EXPECT_LE(guess.distance_m, 123.8 + 1e-9);
  EXPECT_GT(guess.certainty, 0.5);
}

TEST(PlaceFinder, refusesWhatIsNotOnThePath) {
  const PlaceGuess guess = find(path(100, 1000), featuresAt(5000));
  EXPECT_FALSE(guess.sure);
  EXPECT_NE(guess.reason.find("not recognised"), std::string::npos) << guess.reason;
}

TEST(PlaceFinder, refusesWhatLooksLikeTwoPlaces) {
  const PlaceGuess guess = find(path(200, 20), featuresAt(10));  // everything twice
  EXPECT_FALSE(guess.sure);
  EXPECT_NE(guess.reason.find("ambiguous"), std::string::npos) << guess.reason;
  EXPECT_NE(guess.reason.find("10."), std::string::npos) << "both places are named: " << guess.reason;
  EXPECT_NE(guess.reason.find("30."), std::string::npos) << "both places are named: " << guess.reason;
}

TEST(PlaceFinder, aPlaceThatLooksTheSameForLongHidesNoOther) {
  const Path maps = path(400, 1000);
  for (std::size_t i = 100; i < 250; ++i) {  // 30 m of them, and one metre elsewhere
    maps[i]->alternatives = maps[5 * 60]->alternatives;
  }
  const PlaceGuess guess = find(maps, featuresAt(60));
  EXPECT_FALSE(guess.sure);
  EXPECT_NE(guess.reason.find("ambiguous"), std::string::npos) << guess.reason;
}

TEST(PlaceFinder, theEndsOfALoopAreOnePlace) {
  const PlaceGuess guess = find(path(205, 40), featuresAt(0), true);  // the last metre looks like the first
  EXPECT_TRUE(guess.sure) << guess.reason;
  EXPECT_LT(guess.distance_m, 1.0) << "the beginning, of two that are alike";
}

TEST(PlaceFinder, theEndsOfAnOpenPathThatLookAlikeAreAmbiguous) {
  const Path maps = path(205, 40);
  const PlaceGuess guess = find(maps, featuresAt(0));
  EXPECT_FALSE(guess.sure) << guess.reason;
  EXPECT_NE(guess.reason.find("ambiguous"), std::string::npos) << guess.reason;
  EXPECT_NE(guess.reason.find("localisation/loop"), std::string::npos) << "what to do: " << guess.reason;
  EXPECT_TRUE(find(maps, featuresAt(20)).sure) << "elsewhere it does not matter";
}

TEST(PlaceFinder, aShortPathIsNotAllEnds) {
  const PlaceGuess guess = find(path(40, 4), featuresAt(1), true);  // 8 m: 1 m looks like 5 m
  EXPECT_FALSE(guess.sure);
  EXPECT_NE(guess.reason.find("ambiguous"), std::string::npos) << guess.reason;
  EXPECT_EQ(guess.reason.find("localisation/loop"), std::string::npos) << "it is said already";
}

TEST(PlaceFinder, refusesAnEmptyViewAndAnEmptyPath) {
  EXPECT_FALSE(find({}, featuresAt(0)).sure);
  EXPECT_FALSE(find(path(10, 10), {}).sure);
}

TEST(PlaceFinder, everySearchIsOnesOwn) {
  const Path maps = path(100, 1000);
  PlaceFinder finder;
  for (const unsigned place : {3U, 17U, 5U}) {
    finder.seek(featuresAt(place));
    EXPECT_EQ(finder.considered(), 0U);
    for (const auto& map : maps) {
      finder.consider(map);
    }
    EXPECT_EQ(finder.considered(), maps.size());
    const PlaceGuess guess = finder.guess();
    EXPECT_TRUE(guess.sure) << guess.reason;
    EXPECT_NEAR(guess.distance_m, place + 0.4, 0.5);
  }
}

/// Two images in a row, as by default, of a path on which every metre looks different.
class TwoImages : public ::testing::Test {
 protected:
  std::optional<PlaceGuess> look(unsigned place, double travelled_m) {
    localisation_.look(featuresAt(place), travelled_m);
    EXPECT_EQ(localisation_.next(), 0U);
    while (!localisation_.complete()) {
      if (localisation_.considerKept(30) == 0) {
        localisation_.consider(*maps_[localisation_.next()]);
        ++asked_for_;
      }
    }
    return localisation_.conclude();
  }

  const Path maps_ = path(100, 1000);
  int asked_for_ = 0;
  Localisation localisation_{{}, {}, 100};
};

TEST_F(TwoImages, agree) {
  EXPECT_FALSE(look(12, 3.0)) << "one is not enough";
  const auto guess = look(12, 3.0);
  ASSERT_TRUE(guess);
  EXPECT_TRUE(guess->sure) << guess->reason;
  EXPECT_NEAR(guess->distance_m, 12.4, 0.5);
}

TEST_F(TwoImages, agreeOnARobotThatMoves) {
  EXPECT_FALSE(look(12, 3.0));
  const auto guess = look(14, 5.0);
  ASSERT_TRUE(guess);
  EXPECT_TRUE(guess->sure) << guess->reason;
  EXPECT_NEAR(guess->distance_m, 14.4, 0.5) << "where the newest was taken";
}

TEST_F(TwoImages, disagree) {
  EXPECT_FALSE(look(12, 3.0));
  const auto guess = look(15, 3.0);
  ASSERT_TRUE(guess);
  EXPECT_FALSE(guess->sure);
  EXPECT_NE(guess->reason.find("disagree"), std::string::npos) << guess->reason;
}

TEST_F(TwoImages, areRefusedByEither) {
  const auto first = look(5000, 3.0);
  ASSERT_TRUE(first);
  EXPECT_FALSE(first->sure);
  EXPECT_FALSE(look(12, 3.0));
  const auto second = look(5000, 3.0);
  ASSERT_TRUE(second);
  EXPECT_FALSE(second->sure);
}

TEST_F(TwoImages, askForEveryLocalMapOnce) {
  EXPECT_FALSE(look(12, 3.0));
  EXPECT_EQ(asked_for_, 100);
  EXPECT_TRUE(look(12, 3.0));
  EXPECT_EQ(asked_for_, 100);
}

TEST(Localisation, keepsTheBeginningOfAPathThatIsTooLong) {
  constexpr unsigned kFeatures = 200;
  constexpr unsigned kKept = Localisation::kMostKept / kFeatures;
  constexpr unsigned kLocalMaps = kKept + 20;
  ActiveMap map;
  map.alternatives.emplace_back();
  map.alternatives.front().features = featuresAt(1, 0.0, kFeatures);
  Localisation localisation({}, {}, kLocalMaps);
  for (const unsigned missing : {kLocalMaps, kLocalMaps - kKept}) {
    unsigned asked_for = 0;
    localisation.look(featuresAt(7, 0.0, 5), 0.0);
    while (!localisation.complete()) {
      const std::size_t next = localisation.next();
      if (localisation.considerKept(1000) == 0) {
        map.distance_m = static_cast<double>(next);
        localisation.consider(map);
        ++asked_for;
      }
    }
    EXPECT_EQ(asked_for, missing);
    EXPECT_EQ(localisation.considerKept(1000), 0U) << "all were considered";
    localisation.conclude();
  }
}

TEST_F(TwoImages, sayHowFarTheyAre) {
  localisation_.look(featuresAt(3), 0.0);
  localisation_.consider(*maps_[0]);
  EXPECT_EQ(localisation_.progress(), "looking for the place: image 1 of 2, 1 of 100 local maps compared");
}

TEST(LocalisationSettings, outOfRangeIsRefused) {
  for (const char* key : {"min_confidence", "rival_share", "elsewhere_m", "agreement_m"}) {
    ParameterReader reader({{key, -1.0}});
    EXPECT_THROW(LocalisationSettings::load(reader), ParameterError) << key;
  }
  ParameterReader reader({{"agreeing_images", 0}});
  EXPECT_THROW(LocalisationSettings::load(reader), ParameterError);
}

}  // namespace
}  // namespace perennial
