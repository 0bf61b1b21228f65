#include "perennial/park/lighting.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "perennial/park/sun_position.h"

namespace perennial::park {
namespace {

constexpr double kDegPerRad = 57.29577951308232;

std::array<double, 3> towards(const SunPosition& sun) {
  return {std::cos(sun.elevation_rad) * std::sin(sun.azimuth_rad),
          std::cos(sun.elevation_rad) * std::cos(sun.azimuth_rad), std::sin(sun.elevation_rad)};
}

/// Illuminance (klx) by a clear sky without the sun, by the sun's elevation; rounded values of the tables of
/// twilight and daylight (Seidelmann, Explanatory Supplement to the Astronomical Almanac, 1992, section 9.3).
double skyIlluminance(double elevation_deg) {
  struct Entry {
    double elevation_deg, klx;
  };
  static constexpr Entry kTable[] = {{-18.0, 1e-6}, {-12.0, 1e-5}, {-6.0, 3.4e-3}, {-3.0, 0.05},
                                     {0.0, 0.4},    {5.0, 3.0},    {10.0, 6.0},    {20.0, 9.0},
                                     {40.0, 13.0},  {90.0, 17.0}};
  const double elevation = std::clamp(elevation_deg, kTable[0].elevation_deg, 90.0);
  std::size_t i = 1;
  while (i + 1 < std::size(kTable) && kTable[i].elevation_deg < elevation) {
    ++i;
  }
  const Entry& below = kTable[i - 1];
  const Entry& above = kTable[i];
  const double share = (elevation - below.elevation_deg) / (above.elevation_deg - below.elevation_deg);
  return std::exp(std::log(below.klx) * (1.0 - share) + std::log(above.klx) * share);
}

Colour scaled(const Colour& colour, double factor) {
  return {colour[0] * factor, colour[1] * factor, colour[2] * factor};
}

/// Light of the sun after its way through the air: Beer's law with the optical depths of red, green and blue.
Colour sunThroughAir(double elevation_deg) {
  if (elevation_deg < -0.8) {
    return {0.0, 0.0, 0.0};
  }
  const double above = std::max(elevation_deg, 0.0);
  const double air_mass = 1.0 / (std::sin(above / kDegPerRad) + 0.5057 * std::pow(above + 6.08, -1.6364));
  const double risen = std::clamp((elevation_deg + 0.8) / 1.2, 0.0, 1.0);
  return {1.10 * risen * std::exp(-0.10 * air_mass), 1.08 * risen * std::exp(-0.15 * air_mass),
          1.12 * risen * std::exp(-0.25 * air_mass)};
}

struct Air {
  double sun, sky, cloud_cover, haze_per_m, wetness;
};

Air airOf(Weather weather) {
  switch (weather) {
    case Weather::kClear:
      return {1.0, 1.0, 0.35, 0.0015, 0.0};
    case Weather::kOvercast:
      return {0.0, 1.5, 1.0, 0.004, 0.0};
    case Weather::kRain:
      return {0.0, 0.8, 1.0, 0.012, 1.0};
    default:
      return {0.0, 1.2, 1.0, 0.018, 0.3};
  }
}

}  // namespace

Lighting lightingOf(const Conditions& conditions) {
  const SunPosition sun = sunPosition(conditions.date_time_s);
  const double elevation_deg = sun.elevation_rad * kDegPerRad;
  const Air air = airOf(conditions.weather);
  Lighting light;
  light.to_sun = towards(sun);
  light.sun = scaled(sunThroughAir(elevation_deg), air.sun);
  const double level = skyIlluminance(elevation_deg) / 100.0 * air.sky;
  const double low =
      std::clamp(1.0 - std::abs(elevation_deg + 1.0) / 9.0, 0.0, 1.0) * (air.sun > 0.0 ? 1.0 : 0.2);
  light.sky = air.sun > 0.0 ? scaled({0.62, 0.98, 1.75}, level) : scaled({0.98, 1.0, 1.05}, level);
  light.horizon = scaled({1.35 + 0.9 * low, 1.45 + 0.1 * low, 1.6 - 0.5 * low}, level);
  light.cloud_cover = air.cloud_cover;
  light.haze_per_m = air.haze_per_m;
  light.wetness = air.wetness;
  const bool dark = elevation_deg < 2.0;
  const bool on =
      conditions.searchlight == Searchlight::kOn || (conditions.searchlight == Searchlight::kAuto && dark);
  light.searchlight = on ? 0.12 : 0.0;  // 12 klx at one metre
  return light;
}

std::array<double, 3> shadowDirection(double date_time_s) {
  constexpr double kStepS = 20.0;
  return towards(sunPosition(kStepS * std::floor(date_time_s / kStepS)));
}

}  // namespace perennial::park
