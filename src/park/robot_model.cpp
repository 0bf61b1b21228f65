#include "perennial/park/robot_model.h"

#include <algorithm>
#include <cmath>

#include "perennial/core/error.h"

namespace perennial::park {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

double approached(double value, double target, double largest_step) {
  return value + std::clamp(target - value, -largest_step, largest_step);
}

}  // namespace

RobotSettings RobotSettings::load(ParameterReader& reader) {
  RobotSettings s;
  s.max_acceleration = reader.real("max_acceleration", s.max_acceleration, 0.1, 20.0);
  s.max_angular_acceleration = reader.real("max_angular_acceleration", s.max_angular_acceleration, 0.1, 50.0);
  s.max_forward = reader.real("max_forward", s.max_forward, 0.1, 5.0);
  s.max_angular = reader.real("max_angular", s.max_angular, 0.1, 5.0);
  s.command_timeout_s = reader.real("command_timeout_s", s.command_timeout_s, 0.05, 10.0);
  s.odometry_scale_error = reader.real("odometry_scale_error", s.odometry_scale_error, -0.5, 0.5);
  s.odometry_noise = reader.real("odometry_noise", s.odometry_noise, 0.0, 0.5);
  s.heading_drift = reader.real("heading_drift", s.heading_drift, -0.5, 0.5);
  s.heading_noise = reader.real("heading_noise", s.heading_noise, 0.0, 0.5);
  s.turn_slip = reader.real("turn_slip", s.turn_slip, -0.5, 0.5);
  return s;
}

RobotModel::RobotModel(const RobotSettings& settings, std::uint64_t seed)
    : settings_(settings), seed_(seed), random_(seed) {
  place({}, 0);
}

void RobotModel::place(const Pose& pose, std::int64_t now_ns) {
  random_ = Random(mix({static_cast<std::int64_t>(seed_), ++placements_}));
  pose_ = pose;
  velocity_ = commanded_ = Velocity();
  distance_m_ = 0.0;
  command_ns_ = now_ns_ = now_ns;
  odometry_ = Odometry();
  odometry_.stamp_ns = now_ns;
}

void RobotModel::command(const Velocity& velocity, std::int64_t now_ns) {
  if (!std::isfinite(velocity.forward) || !std::isfinite(velocity.angular) ||
      !std::isfinite(velocity.flipper)) {
    throw Error("the commanded velocity is not finite");
  }
  commanded_ = velocity;
  command_ns_ = now_ns;
}

void RobotModel::advance(std::int64_t now_ns) {
  const double dt_s = static_cast<double>(now_ns - now_ns_) / kNanosecondsPerSecond;
  accelerate(dt_s, now_ns);
  const double distance = velocity_.forward * dt_s;
  const double turn = velocity_.angular * dt_s;
  pose_ = moved(pose_, distance, turn);
  distance_m_ += distance;
  now_ns_ = now_ns;
  measure(distance, turn, dt_s);
}

void RobotModel::standUntil(std::int64_t now_ns) {
  velocity_ = commanded_ = Velocity();
  command_ns_ = now_ns_ = now_ns;
  odometry_.stamp_ns = now_ns;
  odometry_.forward = odometry_.angular = 0.0;
}

void RobotModel::accelerate(double dt_s, std::int64_t now_ns) {
  const double age_s = static_cast<double>(now_ns - command_ns_) / kNanosecondsPerSecond;
  const Velocity wanted = age_s > settings_.command_timeout_s ? Velocity() : commanded_;
  velocity_.forward =
      approached(velocity_.forward, std::clamp(wanted.forward, -settings_.max_forward, settings_.max_forward),
                 settings_.max_acceleration * dt_s);
  velocity_.angular =
      approached(velocity_.angular, std::clamp(wanted.angular, -settings_.max_angular, settings_.max_angular),
                 settings_.max_angular_acceleration * dt_s);
  velocity_.flipper = wanted.flipper;
}

void RobotModel::measure(double distance_m, double turn, double dt_s) {
  // The variance grows with the length driven, whatever the length of a step: a random walk in distance.
  const double root = std::sqrt(std::abs(distance_m));
  const double measured = distance_m * (1.0 + settings_.odometry_scale_error) +
                          settings_.odometry_noise * root * random_.normal();
  const double measured_turn = turn * (1.0 + settings_.turn_slip) + settings_.heading_drift * distance_m +
                               settings_.heading_noise * root * random_.normal();
  odometry_.pose = moved(odometry_.pose, measured, measured_turn);
  odometry_.distance_m += measured;
  odometry_.stamp_ns = now_ns_;
  odometry_.forward = dt_s > 0.0 ? measured / dt_s : 0.0;
  odometry_.angular = dt_s > 0.0 ? measured_turn / dt_s : 0.0;
}

}  // namespace perennial::park
