#pragma once

#include "perennial/core/parameter_reader.h"
#include "perennial/core/path_profile.h"

namespace perennial {

/// What a robot may be asked to do. All positive.
struct VelocityLimits {
  double max_forward_mps = 0.5;
  double max_backward_mps = 0.5;
  double max_turn_radps = 0.5;
  double max_flipper_radps = 0.047;
  double max_acceleration_mps2 = 1.0;
  double max_deceleration_mps2 = 2.0;
  double max_turn_acceleration_radps2 = 2.0;

  /// Keys as the members are called; `limits` holds the defaults. Throws ParameterError.
  static VelocityLimits load(ParameterReader& reader, VelocityLimits limits);
  static VelocityLimits load(ParameterReader& reader) { return load(reader, {}); }
};

/// The nearest velocity within the limits.
Velocity clampToLimits(const Velocity& wanted, const VelocityLimits& limits);

/// The velocity to ask for `elapsed_s` after `current`, on the way to `wanted`: within the limits, and no
/// faster than the accelerations allow. Braking uses the deceleration; a change of direction brakes first.
Velocity approach(const Velocity& current, const Velocity& wanted, double elapsed_s,
                  const VelocityLimits& limits);

}  // namespace perennial
