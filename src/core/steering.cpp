#include "perennial/core/steering.h"

#include <algorithm>
#include <cmath>

namespace perennial {

SteeringSettings SteeringSettings::load(ParameterReader& reader) {
  SteeringSettings settings;
  settings.gain_per_rad = reader.real("gain_per_rad", settings.gain_per_rad, 0.0, 20.0);
  settings.gain_per_px = reader.real("gain_per_px", settings.gain_per_px, 0.0, 1.0);
  settings.max_correction = reader.real("max_correction", settings.max_correction, 0.0, 10.0);
  return settings;
}

Velocity slowed(const Velocity& velocity, double share) {
  if (!(share > 0.0)) {
    return {};
  }
  Velocity result = velocity;
  result.forward *= share;
  result.angular *= share;
  return result;
}

Velocity steer(const Velocity& taught, std::optional<double> displacement_px,
               std::optional<double> focal_length_px, const SteeringSettings& settings) {
  double correction = 0.0;
  if (displacement_px) {
    correction = focal_length_px ? settings.gain_per_rad * std::atan(*displacement_px / *focal_length_px)
                                 : settings.gain_per_px * *displacement_px;
  }
  if (!std::isfinite(taught.forward + taught.angular + taught.flipper + correction)) {
    return {};
  }
  const double limited = std::clamp(correction, -settings.max_correction, settings.max_correction);
  return {taught.forward, taught.angular + limited, taught.flipper};
}

}  // namespace perennial
