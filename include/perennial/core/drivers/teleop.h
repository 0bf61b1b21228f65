#pragma once

#include <optional>
#include <vector>

#include "perennial/core/parameter_reader.h"
#include "perennial/core/path_profile.h"

namespace perennial {

struct TeleopSettings {
  double forward_mps = 0.3;  ///< at full speed; keys change a common factor
  double turn_radps = 0.4;
  double flipper_radps = 0.04;
  double key_timeout_s = 0.6;  ///< longer than a keyboard's delay before it repeats a key that is held
  double joy_timeout_s = 0.5;
  int joy_deadman_button = 4;
  int joy_forward_axis = 1;
  int joy_turn_axis = 0;

  /// Keys as the members are called. Throws ParameterError.
  static TeleopSettings load(ParameterReader& reader);
};

/// Turns keys and joystick into velocities with a dead man's behaviour: the robot moves only while a key is
/// held (a terminal repeats it) or the joystick's dead man's button is, and stops when the terminal or
/// joystick falls silent. Times are seconds of one clock of the caller's. Not thread-safe.
///
/// Keys:  u i o   forward, to the left or right      q z  faster, slower
///        j k l   turn left, stop, turn right        r f  flippers up, down
///        m , .   backward, to the left or right
class Teleop {
 public:
  explicit Teleop(const TeleopSettings& settings) : settings_(settings) {}

  /// Any other key stops, too.
  void key(char key, double now_s);
  void joy(const std::vector<float>& axes, const std::vector<int>& buttons, double now_s);

  /// What the person wants now; nothing when nobody holds anything.
  std::optional<Velocity> velocity(double now_s) const;
  double speedFactor() const { return speed_factor_; }

 private:
  struct Wish {
    Velocity velocity;
    double until_s;
  };
  TeleopSettings settings_;
  double speed_factor_ = 1.0;
  std::optional<Wish> wish_;
};

}  // namespace perennial
