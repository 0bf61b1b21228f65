#include "perennial/park/park_simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "perennial/core/error.h"

namespace perennial::park {
namespace {

/// Small images, for what does not depend on them.
ParkSettings small() {
  ParkSettings settings;
  CameraGeometry& geometry = settings.camera.geometry;
  geometry = {94, 60, 72.4, 72.4, 46.5, 29.5};
  return settings;
}

TEST(ParkSimulation, stampsAreSimulatedTime) {
  Conditions conditions;
  ParkSimulation park(small(), conditions);
  const auto start_ns = static_cast<std::int64_t>(conditions.date_time_s) * 1000000000;
  EXPECT_EQ(park.nowNs(), start_ns);
  for (int i = 1; i <= 30; ++i) {
    const ParkFrame frame = park.step();
    EXPECT_EQ(frame.stamp_ns, start_ns + i * 1000000000LL / 15);
    ASSERT_EQ(frame.odometry.size(), 4U);
    EXPECT_EQ(frame.odometry.back().stamp_ns, frame.stamp_ns) << "one measurement belongs to the image";
    EXPECT_EQ(frame.image.size(), cv::Size(94, 60));
    EXPECT_EQ(frame.image.type(), CV_8UC1);
  }
}

TEST(ParkSimulation, replaysToTheByte) {
  ParkSettings settings;
  settings.robot.odometry_noise = 0.02;
  settings.camera.geometry.width = 376;  // narrower, for speed
  Conditions conditions;
  conditions.weather = Weather::kRain;
  ParkSimulation one(settings, conditions), other(settings, conditions);
  one.setDriver(true);
  other.setDriver(true);
  for (int i = 0; i < 10; ++i) {
    one.command(one.driverCommand());
    other.command(other.driverCommand());
    const ParkFrame a = one.step(), b = other.step();
    EXPECT_EQ(cv::norm(a.image, b.image, cv::NORM_INF), 0.0);
    EXPECT_EQ(a.odometry.back().distance_m, b.odometry.back().distance_m);
    EXPECT_EQ(a.true_pose.x, b.true_pose.x);
  }
}

TEST(ParkSimulation, driverGoesOnceRoundTheLoop) {
  ParkSimulation park(small(), {});
  park.setDriver(true);
  std::set<double> rates;
  int changes = 0;
  double previous = 0.0;
  for (int i = 0; i < 700 && !park.driverFinished(); ++i) {
    const Velocity command = park.driverCommand();
    park.command(command);
    changes += command.angular != previous ? 1 : 0;
    previous = command.angular;
    rates.insert(command.angular);
    EXPECT_LT(std::abs(park.step().lateral_m), 0.10) << i;
  }
  EXPECT_TRUE(park.driverFinished());
  EXPECT_NEAR(park.robot().trueDistance(), park.path().length(), 0.3);
  EXPECT_LT(rates.size(), 40U) << "a joystick has steps";
  EXPECT_LT(changes, 170) << "a person corrects a few times a second";
}

TEST(ParkSimulation, placesTheRobotToTheLeftAndTurnedLeft) {
  ParkSimulation park(small(), {});
  park.place(0.4, 0.1);
  const ParkFrame frame = park.step();
  EXPECT_NEAR(frame.lateral_m, 0.4, 1e-6);
  EXPECT_NEAR(frame.true_pose.heading, 0.1, 1e-9);
  EXPECT_EQ(frame.odometry.back().distance_m, 0.0);
  EXPECT_EQ(frame.odometry.back().pose.heading, 0.0);
}

TEST(ParkSimulation, timeNeverGoesBack) {
  Conditions conditions;
  ParkSimulation park(small(), conditions);
  const std::int64_t before_ns = park.step().stamp_ns;

  Conditions winter = conditions;
  winter.date_time_s = parseDateTime("2026-01-15T11:00:00Z");
  park.setConditions(winter);
  const std::int64_t during_ns = park.step().stamp_ns;
  EXPECT_EQ(during_ns - before_ns, 66666667);
  EXPECT_NEAR(park.worldTime(), winter.date_time_s + 1.0 / 15.0, 1e-3);

  Conditions later = conditions;
  later.date_time_s = parseDateTime("2026-10-15T11:00:00Z");
  park.command({1.0, 0.0, 0.0});
  park.setConditions(later);
  const ParkFrame after = park.step();
  EXPECT_EQ(after.stamp_ns, static_cast<std::int64_t>(later.date_time_s) * 1000000000 + 66666666);
  EXPECT_NEAR(park.worldTime(), later.date_time_s + 1.0 / 15.0, 1e-3);
  EXPECT_EQ(park.robot().trueDistance(), 0.0) << "a jump of time finds the robot standing";
}

TEST(ParkSimulation, refusesRatesThatDoNotFit) {
  ParameterReader reader({{"image_rate_hz", 25}, {"odometry_rate_hz", 60}});
  EXPECT_THROW(ParkSettings::load(reader), ParameterError);
}

}  // namespace
}  // namespace perennial::park
