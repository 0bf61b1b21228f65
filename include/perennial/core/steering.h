#pragma once

#include <optional>

#include "perennial/core/parameter_reader.h"
#include "perennial/core/path_profile.h"

namespace perennial {

struct SteeringSettings {
  double gain_per_rad = 2.0;     ///< turn rate per radian of displacement, 1/s; used when the focal length is known
  double gain_per_px = 0.002;    ///< turn rate per pixel of displacement, rad/(s px); used when it is not
  double max_correction = 0.5;   ///< largest turn rate that a displacement may ask for, rad/s
  double max_forward = 1.5;      ///< largest forward and backward velocity sent, m/s
  double max_angular = 1.5;      ///< largest turn rate sent, rad/s
  /// Full speed at this confidence of the registration and above, slower in proportion below. 0: always full speed.
  double slow_below_confidence = 0.0;
  double stop_below_confidence = 0.0;  ///< no motion at this confidence and below. 0: never for this reason

  /// Keys as the members are called. Throws ParameterError.
  static SteeringSettings load(ParameterReader& reader);
};

/// Share of the speed to drive at with a registration of this confidence, 0..1: 1 from `slow_below_confidence` on, 0 up to
/// `stop_below_confidence`, in proportion between. With both at 0: always 1.
double speedShare(double confidence, const SteeringSettings& settings);

/// A velocity slowed down to a share of it along the same curve.
Velocity slowed(const Velocity& velocity, double share);

/// The velocity to send: the taught one, plus a turn rate proportional to the displacement, within the limits
/// (Krajnik et al., "Navigation without localisation", IROS 2018, eq. 2). A positive displacement turns left.
///
/// `focal_length_px`: horizontal focal length, px, positive; none when the camera is not calibrated.
/// Without a displacement the taught velocity alone is sent. Never returns a value that is not finite.
Velocity steer(const Velocity& taught, std::optional<double> displacement_px, std::optional<double> focal_length_px,
               const SteeringSettings& settings);

}  // namespace perennial
