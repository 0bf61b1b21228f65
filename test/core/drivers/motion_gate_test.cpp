#include "perennial/core/drivers/motion_gate.h"

#include <gtest/gtest.h>

#include <limits>

namespace perennial {
namespace {

const Velocity kAhead{0.3, 0.0, 0.0};
const Velocity kZero;

VelocityLimits quickLimits() {
  VelocityLimits limits;
  limits.max_acceleration_mps2 = 100.0;
  limits.max_deceleration_mps2 = 100.0;
  limits.max_turn_acceleration_radps2 = 100.0;
  return limits;
}

MotionGate connectedGate(const VelocityLimits& limits = quickLimits(), double settle_s = 0.0) {
  MotionGate gate(limits, 0.5, settle_s);
  gate.setConnected(true);
  gate.next(0.0);
  return gate;
}

TEST(VelocityLimiter, clampsEveryAxis) {
  VelocityLimits limits;
  limits.max_backward_mps = 0.2;
  EXPECT_EQ(clampToLimits({9.0, -9.0, 9.0}, limits), (Velocity{0.5, -0.5, 0.047}));
  EXPECT_EQ(clampToLimits({-9.0, 0.1, -0.01}, limits), (Velocity{-0.2, 0.1, -0.01}));
}

TEST(VelocityLimiter, limitsAccelerationAndBrakesHarder) {
  const VelocityLimits limits;  // 1 m/s^2 up, 2 m/s^2 down, 2 rad/s^2
  EXPECT_NEAR(approach({0.0, 0.0, 0.0}, {0.5, 0.5, 0.0}, 0.05, limits).forward, 0.05, 1e-12);
  EXPECT_NEAR(approach({0.0, 0.0, 0.0}, {0.5, 0.5, 0.0}, 0.05, limits).angular, 0.1, 1e-12);
  EXPECT_NEAR(approach({0.5, 0.0, 0.0}, {0.2, 0.0, 0.0}, 0.05, limits).forward, 0.4, 1e-12);
  EXPECT_NEAR(approach({0.05, 0.0, 0.0}, {-0.5, 0.0, 0.0}, 0.05, limits).forward, 0.0, 1e-12)
      << "a change of direction stops on the way";
  EXPECT_NEAR(approach({0.0, 0.0, 0.0}, {-0.5, 0.0, 0.0}, 0.05, limits).forward, -0.05, 1e-12);
}

TEST(MotionGate, passesACommandOn) {
  MotionGate gate = connectedGate();
  EXPECT_TRUE(gate.command(kAhead, 1.0));
  EXPECT_EQ(gate.next(1.05), kAhead);
  EXPECT_EQ(gate.holdReason(), "");
}

TEST(MotionGate, stopsAfterTheTimeOut) {
  MotionGate gate = connectedGate();
  gate.command(kAhead, 1.0);
  EXPECT_EQ(gate.next(1.5), kAhead);
  EXPECT_EQ(gate.next(1.51), kZero);
  EXPECT_EQ(gate.next(1.2), kZero) << "a stale command does not come back";
  gate.command(kAhead, 2.0);
  EXPECT_EQ(gate.next(2.05), kAhead);
}

TEST(MotionGate, obeysAfterAPauseOnlyWhenCommandsGoOnComing) {
  MotionGate gate = connectedGate(quickLimits(), 0.2);
  for (const double begin_s : {1.0, 2.0}) {  // the first one ever, and after a time-out
    gate.command(kAhead, begin_s);
    EXPECT_EQ(gate.next(begin_s + 0.05), kZero);
    gate.command(kAhead, begin_s + 0.1);
    EXPECT_EQ(gate.next(begin_s + 0.4), kZero) << "it is commands that count, not time";
    gate.command(kAhead, begin_s + 0.41);
    EXPECT_EQ(gate.next(begin_s + 0.42), kAhead);
  }
}

TEST(MotionGate, doesNotObeyCommandsThatWereHeldBack) {
  MotionGate gate = connectedGate(quickLimits(), 0.2);
  for (int i = 0; i < 10; ++i) {
    gate.command(kAhead, 1.0 + 0.1 * i);
  }
  ASSERT_EQ(gate.next(1.91), kAhead);
  for (int i = 0; i < 5; ++i) {
    gate.command(kAhead, 3.0 + 0.001 * i);  // late and all at once, with no tick since they stopped
  }
  EXPECT_EQ(gate.next(3.05), kZero);
  EXPECT_EQ(gate.next(3.45), kZero);
}

TEST(MotionGate, aClockPutBackStops) {
  MotionGate gate = connectedGate();
  gate.command(kAhead, 100.0);
  EXPECT_EQ(gate.next(99.0), kZero);
}

TEST(MotionGate, holdsUntilAFreshCommand) {
  struct Cause {
    void (*set)(MotionGate&, bool held);
    const char* reason;
  };
  for (const Cause& cause :
       {Cause{[](MotionGate&gate, bool held) { gate.setEmergencyStop(held); }, "emergency"},
        Cause{[](MotionGate&gate, bool held) { gate.setConnected(!held); }, "connected"},
        Cause{[](MotionGate&gate, bool held) { gate.setSystemAlive(!held); }, "master"}}) {
    MotionGate gate = connectedGate();
    gate.command(kAhead, 1.0);
    ASSERT_EQ(gate.next(1.05), kAhead);
    cause.set(gate, true);
    EXPECT_EQ(gate.next(1.10), kZero) << cause.reason;
    EXPECT_NE(gate.holdReason().find(cause.reason), std::string::npos);
    EXPECT_FALSE(gate.command(kAhead, 1.15)) << "no command counts while held";
    EXPECT_EQ(gate.next(1.15), kZero);
    cause.set(gate, false);
    EXPECT_EQ(gate.next(1.20), kZero) << "not even a young command goes on: " << cause.reason;
    gate.command(kAhead, 1.25);
    EXPECT_EQ(gate.next(1.25 + 0.05), kAhead);
  }
}

TEST(MotionGate, ignoresWhatIsNotANumber) {
  MotionGate gate = connectedGate();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(gate.command({nan, 0.0, 0.0}, 1.0));
  EXPECT_FALSE(gate.command({0.0, std::numeric_limits<double>::infinity(), 0.0}, 1.0));
  EXPECT_FALSE(gate.command({0.0, 0.0, nan}, 1.0));
  EXPECT_EQ(gate.next(1.05), kZero);
}

TEST(MotionGate, acceleratesWithinTheLimitsAlsoAfterAPause) {
  MotionGate gate = connectedGate(VelocityLimits());
  gate.command(kAhead, 10.0);
  EXPECT_NEAR(gate.next(10.0).forward, 0.2, 1e-12) << "the longest tick that counts is 0.2 s, at 1 m/s^2";
  EXPECT_NEAR(gate.next(10.05).forward, 0.25, 1e-12);
}

}  // namespace
}  // namespace perennial
