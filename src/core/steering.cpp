#include "perennial/core/steering.h"

#include <algorithm>
#include <cmath>

namespace perennial {
namespace {

double limited(double value, double limit) {
  return std::isfinite(value) ? std::clamp(value, -limit, limit) : 0.0;
}

}  // namespace

SteeringSettings SteeringSettings::load(ParameterReader& reader) {
  SteeringSettings settings;
  settings.gain_per_rad = reader.real("gain_per_rad", settings.gain_per_rad, 0.0, 20.0);
  settings.gain_per_px = reader.real("gain_per_px", settings.gain_per_px, 0.0, 1.0);
  settings.max_correction = reader.real("max_correction", settings.max_correction, 0.0, 10.0);
  settings.max_forward = reader.real("max_forward", settings.max_forward, 0.0, 20.0);
  settings.max_angular = reader.real("max_angular", settings.max_angular, 0.0, 20.0);
  settings.slow_below_confidence =
      reader.real("slow_below_confidence", settings.slow_below_confidence, 0.0, 1.0);
  settings.stop_below_confidence =
      reader.real("stop_below_confidence", settings.stop_below_confidence, 0.0, 1.0);
  return settings;
}

double speedShare(double confidence, const SteeringSettings& settings) {
  const double stop = settings.stop_below_confidence;
  if (stop > 0.0 && confidence <= stop) {
    return 0.0;
  }
  if (confidence >= settings.slow_below_confidence) {
    return 1.0;
  }
  return (confidence - stop) / (settings.slow_below_confidence - stop);
}

Velocity slowed(const Velocity& velocity, double share) {
  Velocity result = velocity;
  result.forward *= share;
  result.angular *= share;
  return result;
}

Velocity steer(const Velocity& taught, std::optional<double> displacement_px, std::optional<double> focal_length_px,
               const SteeringSettings& settings) {
  double correction = 0.0;
  if (displacement_px) {
    correction = focal_length_px ? settings.gain_per_rad * std::atan(*displacement_px / *focal_length_px)
                                 : settings.gain_per_px * *displacement_px;
  }
  Velocity velocity;
  velocity.forward = limited(taught.forward, settings.max_forward);
  velocity.angular = limited(taught.angular + limited(correction, settings.max_correction), settings.max_angular);
  velocity.flipper = std::isfinite(taught.flipper) ? taught.flipper : 0.0;
  return velocity;
}

}  // namespace perennial
