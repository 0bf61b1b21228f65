#pragma once

#include <optional>
#include <string>

#include "perennial/core/drivers/velocity_limiter.h"
#include "perennial/core/path_profile.h"

namespace perennial {

/// Decides what the robot is told to do at every tick of a driver, and above all when it is told to stand
/// still.
///
/// The robot moves only while it is connected, no emergency stop is set, the rest of the system is there, and
/// a command is younger than the time-out. When one of these fails the velocity is zero at once, without
/// braking gently, and it stays zero until a *fresh* command: one that came after the cause had gone, and after
/// others that have come since then: a bad network holds commands back and delivers them late, a few at once.
/// Times are seconds of one clock of the caller's; a clock that goes backwards makes every command stale. Not
/// thread-safe.
class MotionGate {
 public:
  /// `command_timeout_s`: how long a command holds. `command_settle_s`: after a pause, for how long commands
  /// must have been coming before one is obeyed.
  MotionGate(const VelocityLimits& limits, double command_timeout_s, double command_settle_s = 0.0);

  /// A new wish. Returns false, and ignores it, when a value is not finite or the robot may not move now.
  bool command(const Velocity& wanted, double now_s);

  void setEmergencyStop(bool engaged);
  void setConnected(bool connected);
  /// Whether the system that sends the commands (the ROS master) is alive.
  void setSystemAlive(bool alive);

  /// The velocity to send now. To be called once per tick; accelerations are limited between the calls.
  Velocity next(double now_s);

  /// Why the robot must stand still, for a person: empty when it may move.
  std::string holdReason() const;

 private:
  bool held() const { return emergency_stop_ || !connected_ || !system_alive_; }
  bool timedOut(double now_s) const;
  void hold();

  VelocityLimits limits_;
  double command_timeout_s_;
  double command_settle_s_;
  bool emergency_stop_ = false;
  bool connected_ = false;
  bool system_alive_ = true;
  struct Command {
    Velocity wanted;
    double stamp_s;
  };
  std::optional<Command> command_;
  double first_command_s_ = 0.0;  ///< since the last pause
  Velocity sent_;
  std::optional<double> last_tick_s_;
};

}  // namespace perennial
