#include "perennial/core/drivers/motion_gate.h"

#include <algorithm>
#include <cmath>

namespace perennial {
namespace {

constexpr double kLongestTick_s = 0.2;

}  // namespace

MotionGate::MotionGate(const VelocityLimits& limits, double command_timeout_s, double command_settle_s)
    : limits_(limits), command_timeout_s_(command_timeout_s), command_settle_s_(command_settle_s) {}

bool MotionGate::command(const Velocity& wanted, double now_s) {
  const bool finite =
      std::isfinite(wanted.forward) && std::isfinite(wanted.angular) && std::isfinite(wanted.flipper);
  if (!finite || held()) {
    return false;
  }
  if (timedOut(now_s)) {
    hold();
  }
  if (!command_) {
    first_command_s_ = now_s;
  }
  command_ = Command{wanted, now_s};
  return true;
}

void MotionGate::setEmergencyStop(bool engaged) {
  emergency_stop_ = engaged;
  hold();
}

void MotionGate::setConnected(bool connected) {
  connected_ = connected;
  hold();
}

void MotionGate::setSystemAlive(bool alive) {
  if (alive != system_alive_) {
    system_alive_ = alive;
    hold();
  }
}

Velocity MotionGate::next(double now_s) {
  // After a pause in the ticks the robot must not be let off the limits of acceleration.
  const double elapsed = last_tick_s_ ? std::clamp(now_s - *last_tick_s_, 0.0, kLongestTick_s) : 0.0;
  last_tick_s_ = now_s;
  if (timedOut(now_s)) {
    hold();
  }
  if (!command_ || command_->stamp_s - first_command_s_ < command_settle_s_) {
    sent_ = Velocity();
    return sent_;
  }
  sent_ = approach(sent_, command_->wanted, elapsed, limits_);
  return sent_;
}

std::string MotionGate::holdReason() const {
  if (emergency_stop_) {
    return "emergency stop";
  }
  if (!connected_) {
    return "not connected to the robot";
  }
  return system_alive_ ? "" : "the ROS master is gone";
}

bool MotionGate::timedOut(double now_s) const {
  const double age_s = command_ ? now_s - command_->stamp_s : 0.0;
  return age_s < 0.0 || age_s > command_timeout_s_;
}

void MotionGate::hold() {
  command_.reset();
  sent_ = Velocity();
}

}  // namespace perennial
