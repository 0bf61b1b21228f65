#include "perennial/core/drivers/track_odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace perennial {
namespace {

constexpr double kPeriod_s = 0.04;

TrackOdometrySettings settings() { return TrackOdometrySettings(); }

/// Drives `steps` equal steps from wherever the counters are.
struct Drive {
  TrackOdometry odometry{settings()};
  std::int32_t left_mm = 0;
  std::int32_t right_mm = 0;
  double stamp_s = 0.0;

  bool step(std::int32_t left_step, std::int32_t right_step, double period_s = kPeriod_s) {
    left_mm = static_cast<std::int32_t>(static_cast<std::uint32_t>(left_mm) +
                                        static_cast<std::uint32_t>(left_step));
    right_mm = static_cast<std::int32_t>(static_cast<std::uint32_t>(right_mm) +
                                         static_cast<std::uint32_t>(right_step));
    stamp_s += period_s;
    return odometry.update(left_mm, right_mm, stamp_s);
  }
};

TEST(TrackOdometry, drivesStraightOn) {
  Drive drive;
  EXPECT_FALSE(drive.step(0, 0)) << "the first reading is the baseline";
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(drive.step(20, 20));
  }
  EXPECT_NEAR(drive.odometry.state().x_m, 2.0, 1e-9);
  EXPECT_NEAR(drive.odometry.state().y_m, 0.0, 1e-12);
  EXPECT_NEAR(drive.odometry.state().forward_mps, 0.5, 1e-9);
  EXPECT_NEAR(drive.odometry.state().angular_radps, 0.0, 1e-9);
}

TEST(TrackOdometry, followsTheExactArc) {
  // Whatever the size of the steps, an arc ends on the circle: radius way / turn, centre to the left.
  for (const int steps : {1, 3, 50}) {
    TrackOdometrySettings wide = settings();
    wide.max_track_speed_mps = 20.0;
    TrackOdometry odometry(wide);
    odometry.update(0, 0, 0.0);
    for (int i = 1; i <= steps; ++i) {
      EXPECT_TRUE(odometry.update(600 * i / steps, 1200 * i / steps, i * 2.0 / steps));
    }
    const double turn = 0.6 / 0.4;
    const double radius = 0.9 / turn;
    EXPECT_NEAR(odometry.state().yaw_rad, turn, 1e-9);
    EXPECT_NEAR(odometry.state().x_m, radius * std::sin(turn), 1e-3 / steps + 1e-9) << steps << " steps";
    EXPECT_NEAR(odometry.state().y_m, radius * (1.0 - std::cos(turn)), 1e-3 / steps + 1e-9)
        << steps << " steps";
  }
}

TEST(TrackOdometry, turnsOnTheSpotToTheLeft) {
  Drive drive;
  drive.step(0, 0);
  for (int i = 0; i < 25; ++i) {
    drive.step(-8, 8);
  }
  EXPECT_NEAR(drive.odometry.state().yaw_rad, 1.0, 1e-9);
  EXPECT_NEAR(drive.odometry.state().x_m, 0.0, 1e-9);
  EXPECT_NEAR(drive.odometry.state().angular_radps, 1.0, 1e-9);
}

TEST(TrackOdometry, wrapsInBothDirections) {
  Drive drive;
  drive.left_mm = std::numeric_limits<std::int32_t>::max() - 30;
  drive.right_mm = std::numeric_limits<std::int32_t>::max() - 30;
  drive.step(0, 0);
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(drive.step(20, 20));
  }
  EXPECT_LT(drive.left_mm, 0);
  EXPECT_NEAR(drive.odometry.state().x_m, 0.08, 1e-9);
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(drive.step(-20, -20));
  }
  EXPECT_NEAR(drive.odometry.state().x_m, 0.0, 1e-9);
  EXPECT_EQ(drive.odometry.jumps(), 0u);
}

TEST(TrackOdometry, takesAJumpAsANewBaseline) {
  Drive drive;
  drive.step(0, 0);
  drive.step(20, 20);
  const OdometryState before = drive.odometry.state();
  for (const std::int32_t jump : {100000, -5000, 400}) {
    EXPECT_FALSE(drive.step(jump, 20)) << jump;
    EXPECT_EQ(drive.odometry.state().x_m, before.x_m);
    EXPECT_EQ(drive.odometry.state().forward_mps, 0.0);
  }
  EXPECT_EQ(drive.odometry.jumps(), 3u);
  EXPECT_GT(drive.odometry.state().pose_covariance(0, 0), before.pose_covariance(0, 0));
  EXPECT_TRUE(drive.step(20, 20)) << "and goes on from there";
  EXPECT_NEAR(drive.odometry.state().x_m, before.x_m + 0.02, 1e-9);
}

TEST(TrackOdometry, survivesAnyReading) {
  Drive drive;
  const std::int32_t lowest = std::numeric_limits<std::int32_t>::min();
  const std::int32_t highest = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t reading : {0, lowest, highest, -1, lowest, 0}) {
    drive.odometry.update(reading, -(reading + 1), drive.stamp_s += kPeriod_s);
    EXPECT_TRUE(std::isfinite(drive.odometry.state().x_m));
    EXPECT_LT(std::abs(drive.odometry.state().x_m), 0.01);
  }
}

TEST(TrackOdometry, aRestartedRobotDoesNotMoveThePose) {
  Drive drive;
  drive.step(0, 0);
  for (int i = 0; i < 50; ++i) {
    drive.step(20, 20);
  }
  drive.odometry.restart(0.4);
  drive.left_mm = drive.right_mm = 0;
  EXPECT_FALSE(drive.step(0, 0));
  EXPECT_NEAR(drive.odometry.state().x_m, 1.0, 1e-9);
  EXPECT_GE(drive.odometry.state().pose_covariance(0, 0), 0.16);
  EXPECT_EQ(drive.odometry.jumps(), 0u) << "announced, so no jump";
}

TEST(TrackOdometry, takesTheCountersAnewAfterAGap) {
  Drive drive;
  drive.step(0, 0);
  EXPECT_FALSE(drive.step(300, 300, 5.0));
  EXPECT_EQ(drive.odometry.state().x_m, 0.0);
  EXPECT_TRUE(drive.step(300, 300, 1.0)) << "a second of silence is driving";
  EXPECT_NEAR(drive.odometry.state().x_m, 0.3, 1e-9);
}

TEST(TrackOdometry, bunchedReadingsGiveNoFalseVelocity) {
  Drive drive;
  drive.step(0, 0);
  for (int i = 0; i < 100; ++i) {
    // Three loops' readings arrive together.
    EXPECT_TRUE(drive.step(20, 20, i % 3 == 0 ? 3.0 * kPeriod_s : 0.0));
    if (i > 10) {
      EXPECT_NEAR(drive.odometry.state().forward_mps, 0.5, 0.26);
    }
  }
  EXPECT_TRUE(drive.step(20, 20, -10.0)) << "a clock that was put back";
  EXPECT_TRUE(std::isfinite(drive.odometry.state().forward_mps));
}

TEST(TrackOdometry, covarianceGrowsWithDistance) {
  Drive drive;
  drive.step(0, 0);
  double last_yaw = 0.0;
  for (int metre = 1; metre <= 3; ++metre) {
    for (int i = 0; i < 50; ++i) {
      drive.step(20, 20);
    }
    const cv::Matx33d covariance = drive.odometry.state().pose_covariance;
    // Straight on: both tracks add their variance, divided by the square of the base.
    EXPECT_NEAR(covariance(2, 2), metre * 2.0 * 0.0004 / (0.4 * 0.4), 1e-9);
    EXPECT_NEAR(covariance(0, 0), metre * 0.5 * 0.0004, 1e-9);
    EXPECT_GT(covariance(2, 2), last_yaw);
    last_yaw = covariance(2, 2);
  }
  EXPECT_GT(drive.odometry.state().pose_covariance(1, 1), drive.odometry.state().pose_covariance(0, 0))
      << "an uncertain heading makes the side uncertain";
}

TEST(TrackOdometry, staysWhereItIsWhenNothingMoves) {
  Drive drive;
  drive.step(0, 0);
  for (int i = 0; i < 100; ++i) {
    drive.step(0, 0);
  }
  EXPECT_EQ(drive.odometry.state().pose_covariance, cv::Matx33d::zeros());
  EXPECT_EQ(drive.odometry.state().forward_mps, 0.0);
}

}  // namespace
}  // namespace perennial
