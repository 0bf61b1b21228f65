#include "perennial/park/robot_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "perennial/core/error.h"

namespace perennial::park {
namespace {

constexpr std::int64_t kTickNs = 1000000000 / 60;

/// Drives for some ticks, with the command renewed at each.
void drive(RobotModel& robot, std::int64_t& now_ns, const Velocity& velocity, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    robot.command(velocity, now_ns);
    now_ns += kTickNs;
    robot.advance(now_ns);
  }
}

RobotSettings agile() {
  RobotSettings settings;
  settings.max_acceleration = 1e6;
  settings.max_angular_acceleration = 1e6;
  return settings;
}

TEST(RobotModel, drivesExactArcs) {
  RobotModel robot(agile(), 1);
  std::int64_t now_ns = 0;
  drive(robot, now_ns, {1.0, 0.5, 0.0}, 120);
  const double t = 1e-9 * static_cast<double>(now_ns);
  const double radius = 2.0;
  EXPECT_NEAR(robot.truePose().x, radius * std::sin(0.5 * t), 1e-9);
  EXPECT_NEAR(robot.truePose().y, radius * (1.0 - std::cos(0.5 * t)), 1e-9) << "a positive rate turns left";
  EXPECT_NEAR(robot.truePose().heading, 0.5 * t, 1e-9);
  EXPECT_NEAR(robot.trueDistance(), t, 1e-9);
  EXPECT_NEAR(robot.odometry().distance_m, t, 1e-9) << "without errors the odometry is exact";
  EXPECT_EQ(robot.odometry().stamp_ns, now_ns);
}

TEST(RobotModel, keepsItsLimits) {
  RobotSettings settings;
  settings.max_acceleration = 1.5;
  settings.max_forward = 1.2;
  RobotModel robot(settings, 1);
  std::int64_t now_ns = 0;
  drive(robot, now_ns, {5.0, 0.0, 0.0}, 30);
  EXPECT_NEAR(robot.velocity().forward, 0.75, 1e-6);
  drive(robot, now_ns, {5.0, 0.0, 0.0}, 60);
  EXPECT_EQ(robot.velocity().forward, 1.2);
}

TEST(RobotModel, stopsWithoutCommands) {
  RobotModel robot(agile(), 1);
  std::int64_t now_ns = 0;
  drive(robot, now_ns, {1.0, 0.2, 0.0}, 10);
  for (int i = 0; i < 29; ++i) {
    robot.advance(now_ns += kTickNs);
  }
  EXPECT_EQ(robot.velocity().forward, 1.0) << "0.5 s are not over";
  robot.advance(now_ns += kTickNs);
  robot.advance(now_ns += kTickNs);
  EXPECT_EQ(robot.velocity().forward, 0.0);
  EXPECT_EQ(robot.velocity().angular, 0.0);
}

TEST(RobotModel, refusesVelocitiesThatAreNotFinite) {
  RobotModel robot({}, 1);
  EXPECT_THROW(robot.command({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, 0), Error);
  EXPECT_THROW(robot.command({0.0, std::numeric_limits<double>::infinity(), 0.0}, 0), Error);
}

// After d metres the distance is wrong by a normal error of sigma = noise * sqrt(d * 1 m), whatever the step.
TEST(RobotModel, odometryNoiseGrowsWithTheRootOfTheDistance) {
  RobotSettings settings = agile();
  settings.odometry_noise = 0.02;
  for (const double speed : {0.5, 1.0}) {
    double sum = 0.0, sum2 = 0.0, length = 0.0;
    constexpr int kRuns = 400;
    for (int run = 0; run < kRuns; ++run) {
      RobotModel robot(settings, static_cast<std::uint64_t>(run));
      std::int64_t now_ns = 0;
      drive(robot, now_ns, {speed, 0.0, 0.0}, 540);
      const double error = robot.odometry().distance_m - robot.trueDistance();
      sum += error;
      sum2 += error * error;
      length = robot.trueDistance();
    }
    const double sigma = 0.02 * std::sqrt(length);
    EXPECT_NEAR(sum / kRuns, 0.0, 4.0 * sigma / std::sqrt(kRuns));
    EXPECT_NEAR(std::sqrt(sum2 / kRuns) / sigma, 1.0, 4.0 / std::sqrt(2.0 * kRuns));
  }
}

TEST(RobotModel, systematicErrorsAreWhatTheyAreCalled) {
  RobotSettings settings = agile();
  settings.odometry_scale_error = 0.03;
  settings.heading_drift = 0.01;
  settings.turn_slip = -0.1;
  RobotModel robot(settings, 1);
  std::int64_t now_ns = 0;
  drive(robot, now_ns, {1.0, 0.3, 0.0}, 300);
  const double t = 1e-9 * static_cast<double>(now_ns);
  EXPECT_NEAR(robot.odometry().distance_m, 1.03 * t, 1e-9);
  EXPECT_NEAR(robot.odometry().pose.heading, (0.9 * 0.3 + 0.01) * t, 1e-9);
}

TEST(RobotModel, placingStartsOdometryAnewWithOtherNoise) {
  RobotSettings settings = agile();
  settings.odometry_noise = 0.02;
  RobotModel robot(settings, 1);
  std::int64_t now_ns = 0;
  drive(robot, now_ns, {1.0, 0.0, 0.0}, 60);
  const double first = robot.odometry().distance_m;
  robot.place({1.0, 2.0, 0.5}, now_ns);
  EXPECT_EQ(robot.odometry().distance_m, 0.0);
  EXPECT_EQ(robot.odometry().pose.x, 0.0);
  EXPECT_EQ(robot.truePose().y, 2.0);
  drive(robot, now_ns, {1.0, 0.0, 0.0}, 60);
  EXPECT_NE(robot.odometry().distance_m, first);
}

}  // namespace
}  // namespace perennial::park
