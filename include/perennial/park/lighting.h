#pragma once

#include <array>

#include "perennial/park/conditions.h"

namespace perennial::park {

using Colour = std::array<double, 3>;  ///< red, green, blue; linear

/// The light in the park. Unit of radiance: a white sheet lying in the sun of noon has about 1 (some 100
/// klx).
struct Lighting {
  std::array<double, 3> to_sun = {0.0, 0.0, 1.0};  ///< unit vector; x east, y north, z up
  Colour sun = {};                                 ///< irradiance of a surface facing the sun, / pi
  Colour sky = {};                                 ///< radiance of the sky overhead
  Colour horizon = {};                             ///< radiance of the sky at the horizon, and of haze
  double cloud_cover = 0.3;                        ///< [0, 1]
  double haze_per_m = 0.002;                       ///< share of the light lost per metre
  double wetness = 0.0;                            ///< [0, 1]
  double searchlight = 0.0;  ///< radiance of a white sheet 1 m in front of the searchlight
};

/// Light at the conditions' time, from the sun's elevation and the weather.
Lighting lightingOf(const Conditions& conditions);

/// Direction of the sun in the shadow map. It moves in steps of 20 s (0.1 degrees) only, counted from 1970,
/// so that the map is seldom redrawn and an image does not depend on those before it.
std::array<double, 3> shadowDirection(double date_time_s);

}  // namespace perennial::park
