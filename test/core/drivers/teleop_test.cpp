#include "perennial/core/drivers/teleop.h"

#include <gtest/gtest.h>

#include <limits>

namespace perennial {
namespace {

const std::vector<int> kHeld = {0, 0, 0, 0, 1};
const std::vector<int> kReleased = {0, 0, 0, 0, 0};

TEST(Teleop, movesWhileAKeyIsHeldAndNoLonger) {
  Teleop teleop{TeleopSettings()};
  EXPECT_FALSE(teleop.velocity(0.0));
  teleop.key('i', 1.0);
  EXPECT_EQ(teleop.velocity(1.5), (Velocity{0.3, 0.0, 0.0}));
  teleop.key('i', 1.5);
  EXPECT_TRUE(teleop.velocity(2.05));
  EXPECT_FALSE(teleop.velocity(2.11));
}

TEST(Teleop, knowsDirections) {
  Teleop teleop{TeleopSettings()};
  teleop.key('u', 0.0);
  EXPECT_EQ(teleop.velocity(0.0), (Velocity{0.3, 0.4, 0.0}));
  teleop.key(',', 0.0);
  EXPECT_EQ(teleop.velocity(0.0), (Velocity{-0.3, 0.0, 0.0}));
  teleop.key('l', 0.0);
  EXPECT_EQ(teleop.velocity(0.0)->angular, -0.4);
  teleop.key('f', 0.0);
  EXPECT_EQ(teleop.velocity(0.0)->flipper, -0.04);
  teleop.key('k', 0.0);
  EXPECT_EQ(teleop.velocity(0.0), Velocity());
}

TEST(Teleop, changesSpeedWithoutMoving) {
  Teleop teleop{TeleopSettings()};
  teleop.key('q', 0.0);
  EXPECT_FALSE(teleop.velocity(0.0));
  teleop.key('i', 0.0);
  EXPECT_NEAR(teleop.velocity(0.0)->forward, 0.33, 1e-12);
  for (int i = 0; i < 100; ++i) {
    teleop.key('z', 0.0);
  }
  EXPECT_NEAR(teleop.speedFactor(), 0.1, 1e-12);
}

TEST(Teleop, joystickNeedsItsDeadMansButton) {
  Teleop teleop{TeleopSettings()};
  teleop.joy({0.5F, 1.0F}, kReleased, 0.0);
  EXPECT_FALSE(teleop.velocity(0.0));
  teleop.joy({0.5F, 1.0F}, kHeld, 0.0);
  EXPECT_EQ(teleop.velocity(0.1), (Velocity{0.3, 0.2, 0.0}));
  EXPECT_FALSE(teleop.velocity(0.6)) << "a joystick that fell silent";
  teleop.joy({0.0F, 1.0F}, kHeld, 1.0);
  teleop.joy({0.0F, 1.0F}, kReleased, 1.1);
  EXPECT_FALSE(teleop.velocity(1.1));
}

TEST(Teleop, survivesOddJoysticks) {
  Teleop teleop{TeleopSettings()};
  teleop.joy({}, {}, 0.0);
  EXPECT_FALSE(teleop.velocity(0.0));
  teleop.joy({}, kHeld, 0.0);
  EXPECT_EQ(teleop.velocity(0.0), Velocity());
  teleop.joy({std::numeric_limits<float>::quiet_NaN(), 7.0F}, kHeld, 0.0);
  EXPECT_EQ(teleop.velocity(0.0), (Velocity{0.3, 0.0, 0.0}));
}

}  // namespace
}  // namespace perennial
