#include "perennial/park/scripted_driver.h"

#include <cmath>

namespace perennial::park {

DriverSettings DriverSettings::load(ParameterReader& reader) {
  DriverSettings s;
  s.speed = reader.real("driver_speed", s.speed, 0.1, 3.0);
  s.look_ahead_m = reader.real("driver_look_ahead_m", s.look_ahead_m, 0.2, 3.0);
  s.command_interval_s = reader.real("driver_command_interval_s", s.command_interval_s, 0.0, 1.0);
  s.angular_step = reader.real("driver_angular_step", s.angular_step, 0.001, 0.5);
  return s;
}

ScriptedDriver::ScriptedDriver(const LoopPath& path, const DriverSettings& settings)
    : path_(path), settings_(settings) {}

void ScriptedDriver::start() {
  arc_length_m_ = 0.0;
  next_command_s_ = 0.0;
  finished_ = false;
  command_ = Velocity();
}

Velocity ScriptedDriver::drive(const Pose& pose, double time_s) {
  constexpr double kWindowM = 1.5;  // The robot cannot have come further than this since the last call.
  const double here = path_.nearest(pose.x, pose.y, arc_length_m_, kWindowM).arc_length_m;
  const double progress = here - arc_length_m_;
  arc_length_m_ += progress - path_.length() * std::round(progress / path_.length());
  finished_ = finished_ || arc_length_m_ >= path_.length();
  if (finished_) {
    return Velocity();
  }
  if (time_s >= next_command_s_) {
    command_ = pursue(pose);
    next_command_s_ = time_s + settings_.command_interval_s;
  }
  return command_;
}

Velocity ScriptedDriver::pursue(const Pose& pose) const {
  const Pose target = path_.at(arc_length_m_ + settings_.look_ahead_m);
  const double dx = target.x - pose.x;
  const double dy = target.y - pose.y;
  const double left = -dx * std::sin(pose.heading) + dy * std::cos(pose.heading);
  const double curvature = 2.0 * left / (dx * dx + dy * dy);
  Velocity velocity;
  velocity.forward = settings_.speed;
  velocity.angular =
      settings_.angular_step * std::round(settings_.speed * curvature / settings_.angular_step);
  return velocity;
}

}  // namespace perennial::park
