// The parts that a repeat is made of: path profile, steering, odometer, window of local maps, along-path
// correction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "perennial/core/active_map.h"
#include "perennial/core/along_path.h"
#include "perennial/core/error.h"
#include "perennial/core/odometer.h"
#include "perennial/core/path_profile.h"
#include "perennial/core/steering.h"

namespace perennial {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(PathProfile, isAStepFunctionOfDistance) {
  PathProfile profile;
  EXPECT_EQ(profile.at(1.0), Velocity{}) << "an empty profile stands still";
  profile.add(0.0, {0.5, 0.0, 0.0});
  profile.add(1.0, {0.5, 0.0, 0.0});
  profile.add(2.0, {0.5, 0.3, 0.0});
  EXPECT_EQ(profile.entries().size(), 2U) << "an unchanged velocity is no entry";
  EXPECT_EQ(profile.at(-1.0).angular, 0.0);
  EXPECT_EQ(profile.at(1.999).angular, 0.0);
  EXPECT_EQ(profile.at(2.0).angular, 0.3);
  EXPECT_EQ(profile.at(1e9).angular, 0.3);
}

TEST(PathProfile, theLastOfSeveralEntriesAtOneDistanceHolds) {
  PathProfile profile;
  profile.add(0.0, {});
  profile.add(0.0, {0.5, 0.0, 0.0});
  EXPECT_EQ(profile.at(0.0).forward, 0.5);
}

TEST(PathProfile, stopsAreNotRepeated) {
  PathProfile profile;
  profile.add(0.0, {0.5, 0.0, 0.0});
  profile.add(1.0, {});
  profile.add(1.02, {0.3, 0.0, 0.0});  // the robot had coasted
  profile.add(2.0, {});
  EXPECT_EQ(profile.at(1.01).forward, 0.0);
  EXPECT_EQ(profile.travellingAt(1.01).forward, 0.3);
  EXPECT_EQ(profile.travellingAt(2.5).forward, 0.3) << "the end of the path must be reached";
}

TEST(PathProfile, refusesNonsense) {
  PathProfile profile;
  profile.add(1.0, {});
  EXPECT_THROW(profile.add(0.5, {}), Error);
  EXPECT_THROW(profile.add(kNan, {}), Error);
  EXPECT_THROW(profile.add(2.0, {kNan, 0.0, 0.0}), Error);
}

TEST(Steering, aPositiveDisplacementTurnsLeft) {
  SteeringSettings settings;
  const Velocity taught{0.5, 0.1, 0.0};
  EXPECT_GT(steer(taught, 30.0, 500.0, settings).angular, 0.1);
  EXPECT_LT(steer(taught, -30.0, 500.0, settings).angular, 0.1);
  EXPECT_EQ(steer(taught, std::nullopt, 500.0, settings), taught);
  EXPECT_NEAR(steer({}, 50.0, 500.0, settings).angular, settings.gain_per_rad * std::atan(0.1), 1e-12);
  EXPECT_NEAR(steer({}, 50.0, std::nullopt, settings).angular, settings.gain_per_px * 50.0, 1e-12);
}

TEST(Steering, limitsItsCorrectionAndStopsOnNan) {
  SteeringSettings settings;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1e6, 1e6);
  for (int i = 0; i < 1000; ++i) {
    const Velocity taught{any(random), any(random), 0.0};
    const Velocity velocity = steer(taught, any(random), 500.0, settings);
    EXPECT_EQ(velocity.forward, taught.forward);
    EXPECT_LE(std::abs(velocity.angular - taught.angular), settings.max_correction + 1e-6);
  }
  EXPECT_EQ(steer({kNan, 0.1, 0.0}, 10.0, 500.0, settings), Velocity());
  EXPECT_EQ(steer({0.5, kNan, 0.0}, 10.0, 500.0, settings), Velocity());
  EXPECT_EQ(steer({0.5, 0.1, kNan}, 10.0, 500.0, settings), Velocity());
  EXPECT_EQ(steer({0.5, 0.1, 0.0}, kNan, 500.0, settings), Velocity());
  EXPECT_EQ(steer({0.5, 0.1, 0.0}, 10.0, kNan, settings), Velocity()) << "unguided is not straight on";
}

TEST(Steering, slowedKeepsTheCurve) {
  EXPECT_EQ(slowed({1.0, 0.4, 0.1}, 0.5), (Velocity{0.5, 0.2, 0.1}))
      << "flippers do not move the robot along";
  EXPECT_EQ(slowed({1.0, 0.4, 0.1}, 0.0), Velocity{});
}

OdometrySample at(double stamp_s, double x_m, double y_m = 0.0) { return {stamp_s, x_m, y_m, 0.0, 0.0}; }

TEST(Odometer, sumsTheLengthsOfSteps) {
  Odometer odometer;
  EXPECT_FALSE(odometer.distanceAt(0.0));
  EXPECT_EQ(odometer.add(at(1.0, 5.0)), "");
  EXPECT_EQ(odometer.add(at(2.0, 5.3, 0.4)), "");
  EXPECT_EQ(odometer.add(at(3.0, 5.0)), "") << "backwards";
  EXPECT_NEAR(odometer.newestDistance(), 1.0, 1e-12);
  EXPECT_NEAR(*odometer.distanceAt(2.5), 0.75, 1e-12) << "interpolated";
  EXPECT_EQ(*odometer.distanceAt(1.0), 0.0);
  EXPECT_FALSE(odometer.distanceAt(3.01)) << "still to come";
  EXPECT_FALSE(odometer.distanceAt(0.99)) << "before the first";
}

TEST(Odometer, refusesNonsenseAndKeepsWhatItHas) {
  Odometer odometer;
  odometer.add(at(1.0, 0.0));
  odometer.add(at(2.0, 0.5));
  EXPECT_NE(odometer.add(at(3.0, kNan)), "");
  EXPECT_NE(odometer.add(at(1.5, 0.6)), "") << "back in time";
  EXPECT_NE(odometer.add(at(2.1, 100.0)), "") << "a jump";
  EXPECT_NEAR(odometer.newestDistance(), 0.5, 1e-12);
  EXPECT_EQ(odometer.add(at(2.1, 0.55)), "");
}

/// Why a step of an odometer with its defaults is refused, at 1 m/s before.
std::string stepOf(double step_m, double after_s) {
  Odometer odometer;
  for (int i = 0; i <= 10; ++i) {
    EXPECT_EQ(odometer.add(at(after_s * i, after_s * i)), "");
  }
  return odometer.add(at(11 * after_s, 10 * after_s + step_m));
}

TEST(Odometer, refusesJumpsThatNoSuchRobotDrives) {
  for (const double jump_m : {0.5, 0.9}) {
    EXPECT_NE(stepOf(jump_m, 0.1).find("jumps"), std::string::npos) << jump_m;
    EXPECT_NE(stepOf(-jump_m, 0.1), "") << "backwards, too";
    EXPECT_NE(stepOf(jump_m, 0.02), "") << jump_m;
  }
  EXPECT_NE(stepOf(0.9, 0.2), "") << "of a slow odometry";
}

TEST(Odometer, believesWhatPeopleAndRobotsDrive) {
  EXPECT_EQ(stepOf(0.15, 0.1), "") << "1.5 m/s at 10 Hz";
  EXPECT_EQ(stepOf(0.5, 0.2), "") << "driven by hand, 2.5 m/s at 5 Hz";
  EXPECT_EQ(stepOf(1.5, 1.0), "") << "after a pause of the network";
  EXPECT_EQ(stepOf(0.04, 0.005), "") << "noise between samples that come fast";
}

TEST(Odometer, believesABurstThatWasStampedOnArrival) {
  Odometer odometer;
  double x_m = 0.0;
  EXPECT_EQ(odometer.add(at(0.0, x_m)), "");
  for (int i = 0; i < 10; ++i) {  // a second of 1.5 m/s at 10 Hz that comes all at once
    EXPECT_EQ(odometer.add(at(1.0 + 0.001 * i, x_m += 0.15)), "") << i;
  }
  EXPECT_NEAR(odometer.newestDistance(), 1.5, 1e-9);
}

TEST(Odometer, believesNoisyStampsAndPlaces) {
  Odometer odometer;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (int i = 0; i < 1000; ++i) {
    const double stamp_s = 0.1 * i + std::clamp(noise(random), -0.04, 0.04);
    ASSERT_EQ(odometer.add(at(stamp_s, 0.15 * i + noise(random), noise(random))), "") << i;
  }
}

TEST(Odometer, keepsOnlyItsHistory) {
  OdometerSettings settings;
  settings.history_s = 1.0;
  Odometer odometer(settings);
  for (int i = 0; i <= 100; ++i) {
    odometer.add(at(0.1 * i, 0.01 * i));
  }
  EXPECT_FALSE(odometer.distanceAt(5.0));
  EXPECT_NEAR(*odometer.distanceAt(9.5), 0.95, 1e-9);
}

ActiveMap mapAt(std::uint32_t index, double distance_m) {
  ActiveMap map;
  map.index = index;
  map.distance_m = distance_m;
  map.alternatives.emplace_back();
  return map;
}

TEST(ActiveMapWindow, knowsWhenTheNearestMapIsStillToCome) {
  ActiveMapWindow window;
  window.reset(10);
  EXPECT_EQ(window.nearest(0.0), nullptr);
  window.add(mapAt(3, 0.6));
  window.add(mapAt(4, 0.8));
  EXPECT_EQ(window.nearest(0.65)->index, 3U);
  EXPECT_EQ(window.nearest(0.7)->index, 3U) << "of two equally near the earlier";
  EXPECT_EQ(window.nearest(0.85), nullptr) << "map 5 may be nearer";
  EXPECT_EQ(window.nearest(0.5), nullptr) << "map 2 may be nearer";
  window.reset(5);
  window.add(mapAt(4, 0.8));
  EXPECT_EQ(window.nearest(0.9)->index, 4U) << "the last one of the path";
}

TEST(ActiveMapWindow, forgetsWhatLiesBehindAndStartsAnewAfterAGap) {
  ActiveMapWindow window;
  window.reset(100);
  for (std::uint32_t i = 0; i < 50; ++i) {
    window.add(mapAt(i, 0.2 * i));
  }
  window.forgetBefore(8.0, 2.0);
  EXPECT_EQ(window.size(), 20U);
  EXPECT_EQ(window.find(29), nullptr);
  EXPECT_EQ(window.find(30)->index, 30U);
  window.add(mapAt(70, 14.0));
  EXPECT_EQ(window.size(), 1U);
}

TEST(ActiveMapWindow, takesWhatItForgotAgain) {
  ActiveMapWindow window;
  window.reset(100);
  EXPECT_FALSE(window.firstBeyond(0.0));
  for (std::uint32_t i = 30; i < 50; ++i) {
    window.add(mapAt(i, 0.2 * i));
  }
  EXPECT_FALSE(window.firstBeyond(6.0));
  EXPECT_EQ(window.firstBeyond(5.9), 30U);
  for (std::uint32_t i = 30; i-- > 0;) {
    window.add(mapAt(i, 0.2 * i));
  }
  EXPECT_EQ(window.size(), 50U);
  EXPECT_EQ(window.nearest(1.0)->index, 5U);
  EXPECT_FALSE(window.firstBeyond(-1.0)) << "nothing lies before the first of the path";
}

TEST(AlongPath, findsTheVertexOfAParabola) {
  for (double vertex = -0.09; vertex <= 0.07; vertex += 0.01) {  // so that the middle one has most
    const auto evidence = [&](double d) {
      return PlaceEvidence{d, static_cast<int>(std::lround(1e6 * (1 - (d - vertex) * (d - vertex))))};
    };
    EXPECT_NEAR(*placeOfView(evidence(-0.2), evidence(0.0), evidence(0.15)), vertex, 1e-3);
  }
}

TEST(AlongPath, goesToANeighbourThatFitsBetterAndNowhereWithoutAMaximum) {
  EXPECT_EQ(*placeOfView({1.0, 50}, {1.2, 40}, {1.4, 30}), 1.0);
  EXPECT_EQ(*placeOfView({1.0, 30}, {1.2, 40}, {1.4, 50}), 1.4);
  EXPECT_FALSE(placeOfView({1.0, 40}, {1.2, 40}, {1.4, 40})) << "all alike";
}

TEST(AlongPath, correctsSlowlyAndWithinItsBound) {
  AlongPathSettings settings;
  AlongPathCorrection correction(settings);
  for (int i = 0; i < 100; ++i) {
    const double before = correction.correction();
    correction.update(10.0 + before, 10.5, 0.05);
    EXPECT_LE(correction.correction() - before, settings.max_correction * 0.05 + 1e-12);
  }
  EXPECT_NEAR(correction.correction(), 0.5, 0.02);
  correction.update(0.0, 1.0, 0.0);
  EXPECT_NEAR(correction.correction(), 0.5, 0.02) << "a robot that stands is not corrected";
  settings.enabled = false;
  AlongPathCorrection off(settings);
  off.update(10.0, 11.0, 1.0);
  EXPECT_EQ(off.correction(), 0.0);
}

}  // namespace
}  // namespace perennial
