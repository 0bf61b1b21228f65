#include "perennial/core/drivers/cameleon_robot.h"

#include <gtest/gtest.h>

#include <limits>

namespace perennial {
namespace {

const CameleonCommand kAhead{CameleonCommandType::kSpeed, 300, 100, 20};
const Velocity kAheadVelocity{0.3, 0.1, 0.02};

CameleonRobot connectedRobot() {
  CameleonRobot robot;
  robot.connect(CameleonHandshake());
  return robot;
}

TEST(CameleonRobot, takesOneCommandALoop) {
  CameleonRobot robot = connectedRobot();
  robot.receive(kAhead);
  robot.receive({CameleonCommandType::kStop, 0, 0, 0});
  EXPECT_EQ(robot.loop(), kAheadVelocity);
  EXPECT_EQ(robot.queued(), 1u);
  EXPECT_EQ(robot.loop(), Velocity());
  EXPECT_NEAR(robot.time_s(), 0.08, 1e-12);
}

TEST(CameleonRobot, standsStillAfterTwentyLoopsWithoutACommand) {
  CameleonRobot robot = connectedRobot();
  robot.receive(kAhead);
  robot.loop();
  for (int i = 0; i < CameleonRobot::kWatchdogLoops; ++i) {
    EXPECT_EQ(robot.loop(), kAheadVelocity) << "loop " << i;
  }
  EXPECT_EQ(robot.loop(), Velocity());
}

TEST(CameleonRobot, onlySpeedStopAndResetFeedTheWatchdog) {
  for (const auto type :
       {CameleonCommandType::kStatus, CameleonCommandType::kEmpty, CameleonCommandType::kReset}) {
    CameleonRobot robot = connectedRobot();
    robot.receive(kAhead);
    robot.loop();
    Velocity velocity;
    for (int i = 0; i < 30; ++i) {
      robot.receive({type, 0, 0, 0});
      velocity = robot.loop();
    }
    EXPECT_EQ(velocity, type == CameleonCommandType::kReset ? kAheadVelocity : Velocity());
  }
}

TEST(CameleonRobot, forgetsTheQueueOfTheLastClient) {
  CameleonRobot robot = connectedRobot();
  robot.receive(kAhead);
  robot.connect(CameleonHandshake());
  EXPECT_EQ(robot.loop(), Velocity());
}

TEST(CameleonRobot, doesNotDriveWhenTheHandshakeLeftDrivingOut) {
  CameleonRobot robot;
  robot.connect({false, true, true, false});
  robot.receive(kAhead);
  EXPECT_EQ(robot.loop(), Velocity());
}

TEST(CameleonRobot, countsTheTracks) {
  CameleonRobot robot = connectedRobot();
  robot.moved(1.0, 0.5);
  EXPECT_EQ(robot.status().left_mm, 900);
  EXPECT_EQ(robot.status().right_mm, 1100);
  robot.receive({CameleonCommandType::kReset, 0, 0, 0});
  robot.loop();
  EXPECT_EQ(robot.status().left_mm, 900) << "a reset does not touch what is transmitted";
  robot.jumpOdometers(10, -10);
  EXPECT_EQ(robot.status().right_mm, 1090);
  robot.restartOdometers();
  EXPECT_EQ(robot.status().left_mm, 0);
  robot.moved(2147483.648, 0.0);
  EXPECT_EQ(robot.status().left_mm, std::numeric_limits<std::int32_t>::min()) << "wraps";
}

}  // namespace
}  // namespace perennial
