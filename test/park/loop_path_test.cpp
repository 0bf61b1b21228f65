#include "perennial/park/loop_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "perennial/park/random.h"

namespace perennial::park {
namespace {

class AnyLoop : public testing::TestWithParam<int> {
 protected:
  LoopPath path_{LoopSettings{33.0, GetParam()}};
};

TEST_P(AnyLoop, isClosedAndStartsAtTheOrigin) {
  const Pose start = path_.at(0.0);
  const Pose end = path_.at(path_.length() - 1e-9);
  EXPECT_NEAR(start.x, 0.0, 1e-12);
  EXPECT_NEAR(start.y, 0.0, 1e-12);
  EXPECT_NEAR(start.heading, 0.0, 1e-12);
  EXPECT_NEAR(std::hypot(end.x, end.y), 0.0, 1e-6);
  EXPECT_NEAR(wrapAngle(end.heading), 0.0, 1e-9);
  EXPECT_EQ(path_.length(), 33.0);
}

// An oracle that knows nothing of straights and arcs: the heading is the direction in which the position
// moves, at one metre per metre, and the curvature is how fast the heading changes.
TEST_P(AnyLoop, isParametrisedByArcLength) {
  constexpr double kStep = 1e-4;
  for (double s = 0.013; s < path_.length(); s += 0.1) {
    const Pose before = path_.at(s - kStep);
    const Pose after = path_.at(s + kStep);
    EXPECT_NEAR(std::hypot(after.x - before.x, after.y - before.y), 2.0 * kStep, 1e-8) << s;
    EXPECT_NEAR(wrapAngle(std::atan2(after.y - before.y, after.x - before.x) - path_.at(s).heading), 0.0,
                1e-3)
        << s;
    if (path_.curvature(s - kStep) == path_.curvature(s + kStep)) {
      EXPECT_NEAR(wrapAngle(after.heading - before.heading) / (2.0 * kStep), path_.curvature(s), 1e-6) << s;
    }
  }
}

TEST_P(AnyLoop, hasStraightsAndBothCurves) {
  int straight = 0, left = 0, right = 0;
  for (double s = 0.0; s < path_.length(); s += 0.1) {
    const double curvature = path_.curvature(s);
    EXPECT_LT(std::abs(curvature), 0.7);
    ++(curvature == 0.0 ? straight : curvature > 0.0 ? left : right);
  }
  EXPECT_GT(straight, 80);
  EXPECT_GT(left, 80);
  EXPECT_GT(right, 15);
}

TEST_P(AnyLoop, findsTheNearestPoint) {
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const double s = random.uniform(0.0, path_.length());
    const double lateral = random.uniform(-0.6, 0.6);
    const Pose pose = path_.at(s);
    const LoopPath::Nearest nearest =
        path_.nearest(pose.x - lateral * std::sin(pose.heading), pose.y + lateral * std::cos(pose.heading));
    EXPECT_NEAR(nearest.lateral_m, lateral, 1e-5) << s;
    const double along = std::abs(nearest.arc_length_m - s);
    EXPECT_LT(std::min(along, path_.length() - along), 2e-3) << s;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, AnyLoop, testing::Values(0, 1, 2, 3, 99));

TEST(LoopPath, isPeriodic) {
  const LoopPath path;
  EXPECT_NEAR(path.at(5.0).x, path.at(5.0 + path.length()).x, 1e-9);
  EXPECT_NEAR(path.at(-1.0).y, path.at(path.length() - 1.0).y, 1e-9);
}

}  // namespace
}  // namespace perennial::park
