#pragma once

namespace perennial::park {

/// Where the park lies: central Europe.
constexpr double kLatitudeDeg = 50.0;
constexpr double kLongitudeDeg = 14.4;

/// Direction of the sun. The park's x axis points east, y north, z up.
struct SunPosition {
  double elevation_rad = 0.0;  ///< above the horizon; negative at night
  double azimuth_rad = 0.0;    ///< from north over east (clockwise), [0, 2 pi)
};

/// Within 0.02 degrees between 1950 and 2050, without refraction (low-precision formulas of the Astronomical
/// Almanac, section C). `date_time_s`: seconds since 1970, UTC.
SunPosition sunPosition(double date_time_s, double latitude_deg = kLatitudeDeg,
                        double longitude_deg = kLongitudeDeg);

}  // namespace perennial::park
