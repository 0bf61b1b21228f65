#pragma once

#include <cstdint>

#include "perennial/core/parameter_reader.h"
#include "perennial/core/path_profile.h"
#include "perennial/park/pose.h"
#include "perennial/park/random.h"

namespace perennial::park {

struct RobotSettings {
  double max_acceleration = 1.5;          ///< m/s^2
  double max_angular_acceleration = 4.0;  ///< rad/s^2
  double max_forward = 1.5;               ///< m/s
  double max_angular = 1.5;               ///< rad/s
  double command_timeout_s = 0.5;         ///< without a command for so long the robot stops
  double odometry_scale_error = 0.0;      ///< the odometry's distance is (1 + this) times the true one
  double odometry_noise =
      0.0;  ///< after d metres the distance is wrong by a normal error of noise * sqrt(d * 1 m)
  double heading_drift = 0.0;  ///< rad/m; systematic drift of the odometry's heading to the left
  double heading_noise = 0.0;  ///< after d metres the heading is wrong by noise * sqrt(d / 1 m) rad
  double turn_slip = 0.0;      ///< the tracks slip: the odometry's turn is (1 + this) times the true one

  /// Keys as the members are called. Throws ParameterError.
  static RobotSettings load(ParameterReader& reader);
};

/// What the odometry says.
struct Odometry {
  std::int64_t stamp_ns = 0;
  Pose pose;                ///< in a frame that starts where the robot was placed
  double distance_m = 0.0;  ///< travelled, backward counts negative
  double forward = 0.0;     ///< m/s, measured
  double angular = 0.0;     ///< rad/s, measured
};

/// A tracked robot: follows commanded velocities within its acceleration limits, exactly along arcs, and
/// measures how far it went with an error. Not thread-safe.
class RobotModel {
 public:
  RobotModel(const RobotSettings& settings, std::uint64_t seed);

  /// Puts the robot somewhere, at rest and without a command; odometry starts anew from zero, with noise of
  /// its own.
  void place(const Pose& pose, std::int64_t now_ns);
  /// Throws Error when a velocity is not finite.
  void command(const Velocity& velocity, std::int64_t now_ns);
  /// Moves on to `now_ns`; steps of 1/60 s or less resolve the accelerations.
  void advance(std::int64_t now_ns);
  /// Stops at once and stands until `now_ns`; for jumps of time.
  void standUntil(std::int64_t now_ns);

  const Pose& truePose() const { return pose_; }
  const Odometry& odometry() const { return odometry_; }
  /// Velocity that the robot really has.
  const Velocity& velocity() const { return velocity_; }
  /// Sum of the lengths really driven since place(), m.
  double trueDistance() const { return distance_m_; }

 private:
  void accelerate(double dt_s, std::int64_t now_ns);
  void measure(double distance_m, double turn, double dt_s);

  RobotSettings settings_;
  std::uint64_t seed_;
  int placements_ = 0;
  Random random_;
  Pose pose_;
  Velocity velocity_;
  Velocity commanded_;
  double distance_m_ = 0.0;
  std::int64_t command_ns_ = 0;
  std::int64_t now_ns_ = 0;
  Odometry odometry_;
};

}  // namespace perennial::park
