// A view is found among all local maps of a path, quickly; refused where nothing or too much looks like it.
#include <chrono>
#include <cstdio>

#include <gtest/gtest.h>

#include "perennial/core/place_finder.h"
#include "perennial/testing/synthetic_place.h"

namespace perennial {
namespace {

using test_tools::SyntheticPlace;

/// Local maps 0.2 m apart; every place, 1 m long, has landmarks of its own, unless it repeats after `period`
/// places.
class Finding : public ::testing::Test {
 protected:
  static FeatureSet featuresAt(unsigned place, double dx = 0.0, std::size_t features = 500) {
    return SyntheticPlace(place, 600).view(0.0, dx, features);
  }

  void addPath(unsigned local_maps, unsigned period) {
    for (unsigned i = 0; i < local_maps; ++i) {
      ActiveMap map;
      map.index = i;
      map.distance_m = 0.2 * i;
      map.alternatives.emplace_back();
      map.alternatives.front().features = featuresAt(i / 5 % period);
      finder_.add(std::move(map));
    }
  }

  PlaceFinder finder_;
};

TEST_F(Finding, findsAPlaceAmongAThousandLocalMapsInUnderASecond) {
  addPath(1000, 1000);
  const FeatureSet view = featuresAt(123, 40.0);
  const auto begin = std::chrono::steady_clock::now();
  const PlaceGuess guess = finder_.find(view);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::printf("1000 local maps of 500 features: %.3f s, %s\n", took.count(), guess.reason.c_str());
  EXPECT_TRUE(guess.sure) << guess.reason;
  EXPECT_GE(guess.distance_m, 123.0 - 1e-9);
  EXPECT_LE(guess.distance_m, 123.8 + 1e-9);
  EXPECT_GT(guess.certainty, 0.5);
  EXPECT_LT(took.count(), 10.0) << "measured: under 1 s on an idle processor; this machine may be busy";
}

TEST_F(Finding, refusesWhatIsNotOnThePath) {
  addPath(100, 1000);
  const PlaceGuess guess = finder_.find(featuresAt(5000));
  EXPECT_FALSE(guess.sure);
  EXPECT_NE(guess.reason.find("not recognised"), std::string::npos) << guess.reason;
}

TEST_F(Finding, refusesWhatLooksLikeTwoPlaces) {
  addPath(200, 20);  // everything twice
  const PlaceGuess guess = finder_.find(featuresAt(10));
  EXPECT_FALSE(guess.sure);
  EXPECT_NE(guess.reason.find("ambiguous"), std::string::npos) << guess.reason;
  EXPECT_NE(guess.reason.find("30."), std::string::npos) << "both places are named: " << guess.reason;
}

TEST_F(Finding, theEndsOfALoopAreOnePlace) {
  addPath(205, 40);  // the last metre looks like the first
  const PlaceGuess guess = finder_.find(featuresAt(0));
  EXPECT_TRUE(guess.sure) << guess.reason;
  EXPECT_LT(guess.distance_m, 1.0) << "the beginning, of two that are alike";
}

TEST_F(Finding, refusesAnEmptyViewAndAnEmptyPath) {
  EXPECT_FALSE(finder_.find(featuresAt(0)).sure);
  addPath(10, 10);
  EXPECT_FALSE(finder_.find({}).sure);
}

}  // namespace
}  // namespace perennial
