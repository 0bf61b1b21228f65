#pragma once

#include <cstdint>
#include <string>

#include "perennial/core/parameter_reader.h"

namespace perennial::park {

enum class Weather { kClear, kOvercast, kRain, kSnow };
enum class Searchlight { kAuto, kOn, kOff };

/// When it is in the park and what the weather is like. Everything in the park follows from these and from
/// nothing else: sun, leaves, grass, snow, what stands around.
struct Conditions {
  double date_time_s = 1782039600.0;  ///< seconds since 1970, UTC; 2026-06-21T11:00:00Z, noon in the park
  Weather weather = Weather::kClear;
  double wind_m_s = 2.0;                         ///< sways leaves and blows them to other places
  int world_seed = 1;                            ///< which park this is
  Searchlight searchlight = Searchlight::kAuto;  ///< kAuto: on when the sun is below 2 degrees

  /// Keys: date_time (ISO 8601), weather (clear, overcast, rain, snow), wind_m_s, world_seed, searchlight
  /// (auto, on, off). A key that is missing keeps its value of `base`. Throws ParameterError.
  static Conditions load(ParameterReader& reader, const Conditions& base);

  /// Days since 1970-01-01; what grows, falls and is parked in the park changes from day to day.
  std::int64_t day() const;
};

/// Seconds since 1970 of an ISO 8601 time such as "2026-06-21T11:00:00Z" (see parseUtc()). Throws
/// ParameterError for anything else, and for times before 1970.
double parseDateTime(const std::string& text);

/// The inverse, rounded down to the second.
std::string formatDateTime(double date_time_s);

/// Day of the year in [0, 366), with its fraction.
double dayOfYear(double date_time_s);

}  // namespace perennial::park
