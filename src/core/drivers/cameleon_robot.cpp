#include "perennial/core/drivers/cameleon_robot.h"

#include <cmath>

namespace perennial {
namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

/// The counters have 32 bits and wrap.
std::int32_t counter(double metres) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(std::llround(metres * 1000.0)));
}

}  // namespace

CameleonRobot::CameleonRobot(const CameleonScale& scale, double track_distance_m)
    : scale_(scale), track_distance_m_(track_distance_m) {}

void CameleonRobot::connect(const CameleonHandshake& handshake) {
  handshake_ = handshake;
  queue_.clear();
}

Velocity CameleonRobot::loop() {
  ++loops_;
  ++loops_without_command_;
  if (!queue_.empty()) {
    obey(queue_.front());
    queue_.pop_front();
  }
  if (loops_without_command_ > kWatchdogLoops) {
    velocity_ = Velocity();
  }
  flipper_rad_ += velocity_.flipper * kLoopPeriod_s;
  return velocity_;
}

void CameleonRobot::moved(double way_m, double turn_rad) {
  left_m_ += way_m - 0.5 * turn_rad * track_distance_m_;
  right_m_ += way_m + 0.5 * turn_rad * track_distance_m_;
}

void CameleonRobot::setAttitude(int pitch_deg, int roll_deg) {
  pitch_deg_ = pitch_deg;
  roll_deg_ = roll_deg;
}

void CameleonRobot::jumpOdometers(std::int32_t left_mm, std::int32_t right_mm) {
  left_m_ += left_mm / 1000.0;
  right_m_ += right_mm / 1000.0;
}

void CameleonRobot::restartOdometers() {
  left_m_ = 0.0;
  right_m_ = 0.0;
}

CameleonStatus CameleonRobot::status() const {
  return {handshake_.odometry, counter(left_m_),
          counter(right_m_),   pitch_deg_,
          roll_deg_,           static_cast<std::int32_t>(std::lround(flipper_rad_ * kDegreesPerRadian)),
          battery_percent_};
}

void CameleonRobot::obey(const CameleonCommand& command) {
  switch (command.type) {
    case CameleonCommandType::kSpeed:
      loops_without_command_ = 0;
      velocity_ = handshake_.drive ? toVelocity(command, scale_) : Velocity();
      break;
    case CameleonCommandType::kStop:
      loops_without_command_ = 0;
      velocity_ = Velocity();
      break;
    case CameleonCommandType::kReset:  // zeroes only a baseline of its own: what it sends goes on counting
      loops_without_command_ = 0;
      break;
    default:
      break;
  }
}

}  // namespace perennial
