#pragma once

#include "perennial/core/parameter_reader.h"
#include "perennial/core/path_profile.h"
#include "perennial/park/loop_path.h"

namespace perennial::park {

struct DriverSettings {
  double speed = 1.0;               ///< m/s
  double look_ahead_m = 0.7;        ///< of the point of the path that is steered at
  double command_interval_s = 0.2;  ///< a person corrects some five times a second
  double angular_step = 0.05;       ///< rad/s; the joystick's resolution

  /// Keys: driver_speed, driver_look_ahead_m, driver_command_interval_s, driver_angular_step. Throws
  /// ParameterError.
  static DriverSettings load(ParameterReader& reader);
};

/// Drives once round the loop as a person with a joystick does: looks a little ahead (pure pursuit, Coulter,
/// CMU-RI-TR-92-01), corrects a few times a second in coarse steps, and lets go when round. Knows the true
/// pose.
class ScriptedDriver {
 public:
  /// The path must outlive the driver.
  ScriptedDriver(const LoopPath& path, const DriverSettings& settings);

  /// Starts a new round, from the start of the path.
  void start();
  /// The command at this time; simulated seconds that never decrease.
  Velocity drive(const Pose& pose, double time_s);
  bool finished() const { return finished_; }

 private:
  Velocity pursue(const Pose& pose) const;

  const LoopPath& path_;
  DriverSettings settings_;
  double arc_length_m_ = 0.0;  ///< not wrapped
  double next_command_s_ = 0.0;
  bool finished_ = false;
  Velocity command_;
};

}  // namespace perennial::park
