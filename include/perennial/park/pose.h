#pragma once

#include <cmath>

namespace perennial::park {

/// Where something is on the ground: x east, y north in metres, heading counter-clockwise from x in radians.
struct Pose {
  double x = 0.0;
  double y = 0.0;
  double heading = 0.0;
};

/// The angle in (-pi, pi] that differs from this one by whole turns.
inline double wrapAngle(double angle) {
  constexpr double kTurn = 2.0 * 3.14159265358979323846;
  return angle - kTurn * std::ceil(angle / kTurn - 0.5);
}

/// Where a robot is that starts here and drives `distance` (m) along an arc that turns it by `turn` (rad);
/// exact.
inline Pose moved(const Pose& start, double distance, double turn) {
  // The chord of the arc is shorter than the arc by sin(turn / 2) / (turn / 2), and lies at half the turn.
  const double half = 0.5 * turn;
  const double chord =
      std::abs(half) < 1e-6 ? distance * (1.0 - half * half / 6.0) : distance * std::sin(half) / half;
  return {start.x + chord * std::cos(start.heading + half), start.y + chord * std::sin(start.heading + half),
          wrapAngle(start.heading + turn)};
}

}  // namespace perennial::park
