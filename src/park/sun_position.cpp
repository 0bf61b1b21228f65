#include "perennial/park/sun_position.h"

#include <cmath>

namespace perennial::park {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadPerDeg = kPi / 180.0;
constexpr double kJ2000S = 946728000.0;  // 2000-01-01T12:00:00Z

}  // namespace

SunPosition sunPosition(double date_time_s, double latitude_deg, double longitude_deg) {
  const double days = (date_time_s - kJ2000S) / 86400.0;
  const double mean_longitude = (280.460 + 0.9856474 * days) * kRadPerDeg;
  const double anomaly = (357.528 + 0.9856003 * days) * kRadPerDeg;
  const double ecliptic_longitude =
      mean_longitude + (1.915 * std::sin(anomaly) + 0.020 * std::sin(2.0 * anomaly)) * kRadPerDeg;
  const double obliquity = (23.439 - 0.0000004 * days) * kRadPerDeg;
  const double right_ascension =
      std::atan2(std::cos(obliquity) * std::sin(ecliptic_longitude), std::cos(ecliptic_longitude));
  const double declination = std::asin(std::sin(obliquity) * std::sin(ecliptic_longitude));
  const double sidereal_deg = 280.46061837 + 360.98564736629 * days + longitude_deg;
  const double hour_angle = sidereal_deg * kRadPerDeg - right_ascension;

  const double latitude = latitude_deg * kRadPerDeg;
  const double up = std::sin(latitude) * std::sin(declination) +
                    std::cos(latitude) * std::cos(declination) * std::cos(hour_angle);
  const double east = -std::cos(declination) * std::sin(hour_angle);
  const double north = std::cos(latitude) * std::sin(declination) -
                       std::sin(latitude) * std::cos(declination) * std::cos(hour_angle);
  const double azimuth = std::atan2(east, north);
  return {std::asin(up), azimuth < 0.0 ? azimuth + 2.0 * kPi : azimuth};
}

}  // namespace perennial::park
