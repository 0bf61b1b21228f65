#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "perennial/core/drivers/cameleon_codec.h"

namespace perennial {

/// The robot's side of the protocol, for simulation: the program that runs on it, and its tracks.
///
/// Its loop takes one queued command every 40 ms, so that a client which sends faster is obeyed late, and
/// stands still after more than 20 loops without a speed, stop or reset command. Its clock is the number of
/// its loops. Who moves the body is not its business: moved() reports what the tracks ran, by its own
/// kinematics or by those of another simulation. Not thread-safe.
class CameleonRobot {
 public:
  static constexpr double kLoopPeriod_s = 0.040;
  static constexpr int kWatchdogLoops = 20;

  explicit CameleonRobot(const CameleonScale& scale = {}, double track_distance_m = 0.40);

  /// A client connects: what was queued for the last one is gone.
  void connect(const CameleonHandshake& handshake);
  void receive(const CameleonCommand& command) { queue_.push_back(command); }

  /// One loop. Returns the velocity of the body until the next one.
  Velocity loop();

  /// The body went `way_m` along and turned by `turn_rad` to the left.
  void moved(double way_m, double turn_rad);
  void setAttitude(int pitch_deg, int roll_deg);
  void setBattery(int percent) { battery_percent_ = percent; }
  /// Makes the odometers jump, or start anew from zero as after a restart.
  void jumpOdometers(std::int32_t left_mm, std::int32_t right_mm);
  void restartOdometers();

  CameleonStatus status() const;
  double time_s() const { return static_cast<double>(loops_) * kLoopPeriod_s; }
  const Velocity& velocity() const { return velocity_; }
  std::size_t queued() const { return queue_.size(); }

 private:
  void obey(const CameleonCommand& command);

  CameleonScale scale_;
  double track_distance_m_;
  CameleonHandshake handshake_;
  std::deque<CameleonCommand> queue_;
  std::uint64_t loops_ = 0;
  int loops_without_command_ = 0;
  Velocity velocity_;
  double left_m_ = 0.0;
  double right_m_ = 0.0;
  double flipper_rad_ = 0.0;
  int pitch_deg_ = 0;
  int roll_deg_ = 0;
  int battery_percent_ = 100;
};

}  // namespace perennial
