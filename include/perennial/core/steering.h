#pragma once

#include <optional>

#include "perennial/core/parameter_reader.h"
#include "perennial/core/path_profile.h"

namespace perennial {

struct SteeringSettings {
  double gain_per_rad =
      2.0;  ///< turn rate per radian of displacement, 1/s; used when the focal length is known
  double gain_per_px = 0.002;   ///< turn rate per pixel of displacement, rad/(s px); used when it is not
  double max_correction = 0.5;  ///< largest turn rate that a displacement may ask for, rad/s

  /// Keys as the members are called. Throws ParameterError.
  static SteeringSettings load(ParameterReader& reader);
};

/// A velocity slowed down to a share of it along the same curve; flippers do not move the robot along and
/// keep theirs. Zero at a share of 0.
Velocity slowed(const Velocity& velocity, double share);

/// The velocity to ask for: the taught one, plus a turn rate proportional to the displacement, within its
/// limit (Krajnik et al., "Navigation without localisation", IROS 2018, eq. 2). A positive displacement turns
/// left.
///
/// `focal_length_px`: horizontal focal length, px, positive; none when the camera is not calibrated.
/// Without a displacement the taught velocity alone is sent. Never returns a value that is not finite.
Velocity steer(const Velocity& taught, std::optional<double> displacement_px,
               std::optional<double> focal_length_px, const SteeringSettings& settings);

}  // namespace perennial
