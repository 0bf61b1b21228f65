#include <gtest/gtest.h>

#include "perennial/core/steering.h"

namespace perennial {
namespace {

TEST(SpeedShare, byDefaultConfidenceDoesNotMatter) {
  for (const double confidence : {0.0, 0.5, 1.0}) {
    EXPECT_EQ(speedShare(confidence, {}), 1.0);
  }
}

TEST(SpeedShare, fallsFromSlowToStop) {
  SteeringSettings settings;
  settings.slow_below_confidence = 0.8;
  settings.stop_below_confidence = 0.2;
  EXPECT_EQ(speedShare(0.9, settings), 1.0);
  EXPECT_EQ(speedShare(0.8, settings), 1.0);
  EXPECT_NEAR(speedShare(0.5, settings), 0.5, 1e-12);
  EXPECT_EQ(speedShare(0.2, settings), 0.0);
  EXPECT_EQ(speedShare(0.0, settings), 0.0);
}

TEST(SpeedShare, stoppingAloneDoesNotSlow) {
  SteeringSettings settings;
  settings.stop_below_confidence = 0.5;
  EXPECT_EQ(speedShare(0.51, settings), 1.0);
  EXPECT_EQ(speedShare(0.5, settings), 0.0);
}

TEST(SpeedShare, slowedKeepsTheCurve) {
  const Velocity velocity = slowed({1.0, 0.4, 0.1}, 0.5);
  EXPECT_EQ(velocity.forward, 0.5);
  EXPECT_EQ(velocity.angular, 0.2);
  EXPECT_EQ(velocity.flipper, 0.1) << "flippers do not move the robot along";
}

}  // namespace
}  // namespace perennial
