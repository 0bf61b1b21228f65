// What forbids motion from outside of navigation, how long, and what wins; and the camera's watch.
#include "perennial/core/motion_interlock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "perennial/core/error.h"
#include "perennial/core/image_watch.h"

namespace perennial {
namespace {

using Kind = MotionPermit::Kind;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(MotionInterlock, allowsByDefault) {
  const MotionPermit permit = MotionInterlock().at(0.0);
  EXPECT_EQ(permit.kind, Kind::kGo);
  EXPECT_EQ(permit.speed_factor, 1.0);
}

TEST(MotionInterlock, anEmergencyStopFromBeforeWaitsForResume) {
  MotionInterlock interlock;
  EXPECT_FALSE(interlock.emergencyStopped());
  interlock.latchEmergencyStop();
  EXPECT_TRUE(interlock.emergencyStopped());
  EXPECT_EQ(interlock.at(0.0).kind, Kind::kStop);
  EXPECT_TRUE(interlock.resume());
  EXPECT_FALSE(interlock.emergencyStopped());
  EXPECT_EQ(interlock.at(0.0).kind, Kind::kGo);
}

TEST(MotionInterlock, emergencyStopsStayUntilResumed) {
  for (const EmergencyStop source : {EmergencyStop::kTopic, EmergencyStop::kService}) {
    MotionInterlock interlock;
    interlock.setEmergencyStop(source, true);
    EXPECT_EQ(interlock.at(1.0).kind, Kind::kStop);
    EXPECT_FALSE(interlock.resume()) << "still engaged";
    interlock.setEmergencyStop(source, false);
    EXPECT_EQ(interlock.at(1.0).kind, Kind::kStop) << "releasing must not start a robot";
    EXPECT_NE(interlock.at(1.0).reason.find("resume"), std::string::npos);
    EXPECT_TRUE(interlock.resume());
    EXPECT_EQ(interlock.at(1.0).kind, Kind::kGo);
  }
}

TEST(MotionInterlock, oneEmergencyStopDoesNotReleaseTheOther) {
  MotionInterlock interlock;
  interlock.setEmergencyStop(EmergencyStop::kTopic, true);
  interlock.setEmergencyStop(EmergencyStop::kService, false);
  EXPECT_FALSE(interlock.resume());
  EXPECT_EQ(interlock.at(1.0).kind, Kind::kStop);
}

TEST(MotionInterlock, aTopicThatSaysAllIsWellStopsNothing) {
  MotionInterlock interlock;
  interlock.setEmergencyStop(EmergencyStop::kTopic, false);
  EXPECT_EQ(interlock.at(1.0).kind, Kind::kGo);
}

TEST(MotionInterlock, needsTheDeadMan) {
  InterlockSettings settings;
  settings.dead_man.kind = DeadManSettings::Kind::kJoy;
  MotionInterlock interlock(settings);
  EXPECT_EQ(interlock.at(1.0).kind, Kind::kStop) << "never heard of";
  interlock.deadMan(true, 1.0, 1.0);
  EXPECT_EQ(interlock.at(1.4).kind, Kind::kGo);
  EXPECT_EQ(interlock.at(1.6).kind, Kind::kStop) << "silent";
  EXPECT_EQ(interlock.at(0.5).kind, Kind::kStop) << "the clock went back";
  interlock.deadMan(false, 2.0, 2.0);
  EXPECT_EQ(interlock.at(2.0).kind, Kind::kStop) << "let go";
}

TEST(MotionInterlock, obstaclesSlowThenHold) {
  InterlockSettings settings;
  settings.obstacles.range = settings.obstacles.scan = true;
  MotionInterlock interlock(settings);
  interlock.obstacle(ObstacleSensor::kRange, kInfinity, 1.0, 1.0);
  EXPECT_EQ(interlock.at(1.0).kind, Kind::kStop) << "the scanner is silent";
  interlock.obstacle(ObstacleSensor::kScan, 1.0, 1.0, 1.0);
  EXPECT_EQ(interlock.at(1.0).kind, Kind::kGo);
  EXPECT_NEAR(interlock.at(1.0).speed_factor, (1.0 + settings.obstacles.least_speed) / 2.0, 1e-12);
  EXPECT_TRUE(interlock.at(1.0).hinders());
  interlock.obstacle(ObstacleSensor::kRange, 0.4, 1.0, 1.0);
  EXPECT_EQ(interlock.at(1.0).kind, Kind::kHold) << "the nearer one counts";
  interlock.obstacle(ObstacleSensor::kRange, 9.0, 1.1, 1.1);
  interlock.obstacle(ObstacleSensor::kScan, 9.0, 1.1, 1.1);
  EXPECT_EQ(interlock.at(1.1).speed_factor, 1.0);
  EXPECT_FALSE(interlock.at(1.1).hinders());
  EXPECT_EQ(interlock.at(2.0).kind, Kind::kStop) << "silent again";
  interlock.obstacle(ObstacleSensor::kRange, kNan, 2.0, 2.0);
  interlock.obstacle(ObstacleSensor::kScan, 9.0, 2.0, 2.0);
  EXPECT_EQ(interlock.at(2.0).kind, Kind::kStop) << "a sensor that does not know";
}

TEST(MotionInterlock, aRobotThatDrivesAtAWallComesToHold) {
  InterlockSettings settings;
  settings.obstacles.range = true;
  MotionInterlock interlock(settings);
  constexpr double kStep_s = 0.1;
  double now_s = 0.0;
  double wall_m = 3.0;
  double before = 1.0;
  const auto look = [&] {
    interlock.obstacle(ObstacleSensor::kRange, wall_m, now_s, now_s);
    return interlock.at(now_s);
  };
  for (MotionPermit permit = look(); permit.kind != Kind::kHold; permit = look()) {
    ASSERT_EQ(permit.kind, Kind::kGo);
    ASSERT_LE(permit.speed_factor, before) << "slower and slower";
    ASSERT_GE(permit.speed_factor, settings.obstacles.least_speed);
    ASSERT_LT(now_s, 30.0) << "still on its way at " << wall_m << " m";
    before = permit.speed_factor;
    wall_m -= 0.3 * permit.speed_factor * kStep_s;
    now_s += kStep_s;
  }
  EXPECT_LE(wall_m, settings.obstacles.stop_distance_m);
  EXPECT_GT(wall_m, settings.obstacles.stop_distance_m - 0.02);
  EXPECT_TRUE(look().hinders());
}

TEST(MotionInterlock, lateMessagesAreNoNews) {
  InterlockSettings settings;
  settings.dead_man.kind = DeadManSettings::Kind::kJoy;
  settings.obstacles.range = true;
  MotionInterlock interlock(settings);
  const auto hear = [&](double joy_stamp_s, double range_stamp_s) {
    interlock.deadMan(true, joy_stamp_s, 10.0);
    interlock.obstacle(ObstacleSensor::kRange, 5.0, range_stamp_s, 10.0);
    return interlock.at(10.0);
  };
  EXPECT_EQ(hear(9.8, 9.8).kind, Kind::kGo);
  EXPECT_EQ(interlock.at(10.4).kind, Kind::kStop) << "the time-out runs from when it was said";
  EXPECT_NE(hear(9.0, 9.8).reason.find("no sign of life"), std::string::npos) << "held a second ago";
  EXPECT_NE(hear(9.8, 9.0).reason.find("range finder is silent"), std::string::npos) << "free a second ago";
  EXPECT_EQ(hear(0.0, 0.0).kind, Kind::kGo) << "without a stamp the arrival counts";
  EXPECT_EQ(interlock.at(10.4).kind, Kind::kGo);
}

TEST(MotionInterlock, doesNotBelieveStampsOfTheFuture) {
  InterlockSettings settings;
  settings.dead_man.kind = DeadManSettings::Kind::kJoy;
  MotionInterlock interlock(settings);
  interlock.deadMan(true, 10.3, 10.0);
  EXPECT_EQ(interlock.at(10.0).kind, Kind::kGo) << "clocks differ a little";
  EXPECT_EQ(interlock.at(10.6).kind, Kind::kStop) << "which prolongs nothing";
  interlock.deadMan(true, 3600.0, 11.0);
  EXPECT_EQ(interlock.at(11.0).kind, Kind::kStop);
  EXPECT_EQ(interlock.at(3600.0).kind, Kind::kStop) << "nor later";
}

TEST(MotionInterlock, ignoresObstacleSensorsThatAreNotSwitchedOn) {
  MotionInterlock interlock;
  interlock.obstacle(ObstacleSensor::kFlag, 0.0, 1.0, 1.0);
  EXPECT_EQ(interlock.at(1.0).kind, Kind::kGo);
}

TEST(MotionInterlock, aPersonsCommandTakesPrecedenceThenPauses) {
  MotionInterlock interlock;
  interlock.teleop({0.3, kNan, 0.0}, 1.0);
  const MotionPermit permit = interlock.at(1.2);
  EXPECT_EQ(permit.kind, Kind::kManual);
  EXPECT_EQ(permit.manual, (Velocity{0.3, 0.0, 0.0}));
  EXPECT_EQ(interlock.at(1.5).kind, Kind::kStop) << "let go: the robot stands before the repeat goes on";
  EXPECT_EQ(interlock.at(2.1).kind, Kind::kGo);
  interlock.setEmergencyStop(EmergencyStop::kTopic, true);
  interlock.teleop({0.3, 0.0, 0.0}, 3.0);
  EXPECT_EQ(interlock.at(3.0).kind, Kind::kStop) << "an emergency stop stops people, too";
}

TEST(MotionInterlock, aPersonMayDriveTheRobotAwayFromWhatStopsIt) {
  InterlockSettings settings;
  settings.obstacles.flag = true;
  MotionInterlock interlock(settings);
  interlock.obstacle(ObstacleSensor::kFlag, 0.0, 1.0, 1.0);
  interlock.setMasterAlive(false);
  interlock.teleop({-0.1, 0.0, 0.0}, 1.0);
  EXPECT_EQ(interlock.at(1.0).kind, Kind::kManual);
}

TEST(MotionInterlock, strangersOnTheCommandTopicStopIt) {
  MotionInterlock interlock;
  interlock.strangerCommanded("/joystick", 1.0);
  EXPECT_EQ(interlock.at(1.5).kind, Kind::kStop);
  EXPECT_NE(interlock.at(1.5).reason.find("/joystick"), std::string::npos);
  EXPECT_EQ(interlock.at(2.5).kind, Kind::kGo);
  interlock.strangerCommanded("/joystick", 3.0);
  interlock.forgetCommands();
  EXPECT_EQ(interlock.at(3.0).kind, Kind::kGo) << "before the goal";
}

TEST(MotionInterlock, needsTheMaster) {
  MotionInterlock interlock;
  interlock.setMasterAlive(false);
  EXPECT_EQ(interlock.at(1.0).kind, Kind::kStop);
  interlock.setMasterAlive(true);
  EXPECT_EQ(interlock.at(1.0).kind, Kind::kGo);
}

TEST(InterlockSettings, refusesWhatMakesNoSense) {
  ParameterReader obstacles({{"slow_distance_m", 0.5}, {"stop_distance_m", 1.0}});
  EXPECT_THROW(ObstacleSettings::load(obstacles), ParameterError);
  ParameterReader standing({{"least_speed", 0.0}});
  EXPECT_THROW(ObstacleSettings::load(standing), ParameterError);
  ParameterReader teleop({{"timeout_s", 2.0}});
  EXPECT_THROW(OverrideSettings::load(teleop), ParameterError);
  ParameterReader dead_man({{"kind", std::string("pedal")}});
  EXPECT_THROW(DeadManSettings::load(dead_man), ParameterError);
  ParameterReader camera({{"frozen_distance_m", 0.0}});
  EXPECT_THROW(ImageWatchSettings::load(camera), ParameterError);
  ParameterReader heartbeat({{"kind", std::string("heartbeat")}});
  EXPECT_EQ(DeadManSettings::load(heartbeat).kind, DeadManSettings::Kind::kHeartbeat);
}

double nearest(const std::vector<float>& ranges) {
  return nearestInCorridor({ranges.data(), ranges.size(), -M_PI / 2.0, M_PI / 4.0, 0.1, 10.0}, {0.4, 1.5});
}

TEST(NearestInCorridor, looksStraightAheadOnly) {
  EXPECT_EQ(nearest({1.0F, 1.0F, 5.0F, 1.0F, 1.0F}), 5.0) << "beside the corridor";
  EXPECT_NEAR(nearest({1.0F, 0.5F, 5.0F, 1.0F, 1.0F}), 0.5 * std::cos(M_PI / 4.0), 1e-6)
      << "0.35 m to the right";
}

TEST(NearestInCorridor, readsTheSpecialValues) {
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(nearest({1.0F, 1.0F, infinity, 1.0F, 1.0F}), kInfinity);
  EXPECT_EQ(nearest({1.0F, 1.0F, 11.0F, 1.0F, 1.0F}), kInfinity) << "beyond its reach";
  EXPECT_NEAR(nearest({1.0F, 1.0F, 0.01F, 1.0F, 1.0F}), 0.01, 1e-6) << "nearer than it measures well";
  EXPECT_EQ(nearest({1.0F, 1.0F, -infinity, 1.0F, 1.0F}), 0.1) << "too near to measure";
}

TEST(NearestInCorridor, knowsWhenItSeesNothing) {
  const float nan = std::nanf("");
  EXPECT_TRUE(std::isnan(nearest({})));
  EXPECT_TRUE(std::isnan(nearest({nan, nan, nan, nan, nan}))) << "covered";
  EXPECT_TRUE(std::isnan(nearest({1.0F, 1.0F, nan, 1.0F, 1.0F}))) << "sees the walls, not the way";
  EXPECT_TRUE(std::isnan(nearest({1.0F, 1.0F, 0.0F, 1.0F, 1.0F}))) << "as many drivers say that they failed";
  EXPECT_TRUE(std::isnan(nearest({1.0F, 1.0F, -1.0F, 1.0F, 1.0F})));
}

TEST(NearestInCorridor, knowsThatItDoesNotLookAhead) {
  const std::vector<float> readings{0.3F, 0.3F};
  const auto towards = [&](double angle, double range_max) {
    return nearestInCorridor({readings.data(), 2, angle, 0.01, 0.1, range_max}, {0.4, 1.5});
  };
  EXPECT_NEAR(towards(0.0, 10.0), 0.3, 1e-3);
  EXPECT_TRUE(std::isnan(towards(M_PI, 10.0))) << "behind";
  EXPECT_TRUE(std::isnan(towards(M_PI / 4.0, 10.0))) << "out of the corridor before its depth";
  EXPECT_TRUE(std::isnan(towards(0.0, 0.0))) << "a scan that does not say how far it reaches";
  EXPECT_TRUE(std::isnan(towards(0.0, kNan)));
}

TEST(NearestInCorridor, someReadingsMayFail) {
  const std::vector<float> readings{std::nanf(""), 2.0F, std::nanf("")};
  EXPECT_NEAR(nearestInCorridor({readings.data(), 3, -0.1, 0.1, 0.1, 10.0}, {0.4, 1.5}), 2.0, 1e-6);
}

class Camera : public ::testing::Test {
 protected:
  std::string look(std::uint8_t pixel, double travelled_m) {
    const std::vector<std::uint8_t> pixels(64, pixel);
    return watch_.checkPixels(pixels.data(), pixels.size(), travelled_m);
  }
  ImageWatch watch_{ImageWatchSettings{3, 0.5}};
};

TEST_F(Camera, isFrozenWhenTheSameImageComesOnTheWay) {
  EXPECT_EQ(look(1, 0.0), "");
  EXPECT_EQ(look(1, 0.1), "");
  EXPECT_EQ(look(1, 0.2), "");
  EXPECT_NE(look(1, 0.3), "");
  EXPECT_NE(look(1, 0.3), "") << "also when the robot stands by now";
  EXPECT_EQ(look(2, 0.3), "");
  EXPECT_EQ(look(2, 0.3), "");
}

TEST_F(Camera, isFrozenWhenTwoImagesFarFromEachOtherAreTheSame) {
  EXPECT_EQ(look(1, 0.0), "");
  EXPECT_NE(look(1, 0.51), "") << "a slow camera, or a fast robot";
  EXPECT_EQ(look(2, 1.0), "");
  EXPECT_EQ(look(2, 1.4), "");
  EXPECT_NE(look(2, 1.52).find("2 times in 0.5 m"), std::string::npos) << "since it was first seen";
  EXPECT_EQ(look(3, 1.6), "");
  EXPECT_EQ(look(2, 9.0), "") << "in between it saw something else";
}

TEST_F(Camera, maySeeTheSameWhileStanding) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(look(1, 7.0 + 0.001 * i), "");
  }
}

TEST_F(Camera, isNotJudgedWhenSwitchedOff) {
  watch_ = ImageWatch(ImageWatchSettings{0, 0.5});
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(look(1, i), "");
  }
}

TEST_F(Camera, stampsMustNotGoBack) {
  EXPECT_EQ(watch_.checkStamp(10.0), "");
  EXPECT_EQ(watch_.checkStamp(10.0), "");
  EXPECT_NE(watch_.checkStamp(9.5), "");
  EXPECT_EQ(watch_.checkStamp(10.1), "");
  watch_.reset();
  EXPECT_EQ(watch_.checkStamp(1.0), "");
}

}  // namespace
}  // namespace perennial
