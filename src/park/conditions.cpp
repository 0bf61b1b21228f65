#include "perennial/park/conditions.h"

#include <cmath>
#include <ctime>
#include <optional>

#include "perennial/core/error.h"
#include "perennial/core/utc_time.h"

namespace perennial::park {
namespace {

constexpr double kSecondsPerDay = 86400.0;

std::tm brokenDown(double date_time_s) {
  const auto seconds = static_cast<std::time_t>(std::floor(date_time_s));
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  return parts;
}

Weather weatherOf(const std::string& name) {
  return name == "clear"      ? Weather::kClear
         : name == "overcast" ? Weather::kOvercast
         : name == "rain"     ? Weather::kRain
                              : Weather::kSnow;
}

std::string nameOf(Weather weather) {
  static const char* const kNames[] = {"clear", "overcast", "rain", "snow"};
  return kNames[static_cast<int>(weather)];
}

std::string nameOf(Searchlight searchlight) {
  static const char* const kNames[] = {"auto", "on", "off"};
  return kNames[static_cast<int>(searchlight)];
}

Searchlight searchlightOf(const std::string& name) {
  return name == "auto" ? Searchlight::kAuto : name == "on" ? Searchlight::kOn : Searchlight::kOff;
}

}  // namespace

Conditions Conditions::load(ParameterReader& reader, const Conditions& base) {
  Conditions conditions = base;
  const std::string date_time = reader.text("date_time", "");
  if (!date_time.empty()) {
    conditions.date_time_s = parseDateTime(date_time);
  }
  conditions.weather =
      weatherOf(reader.choice("weather", nameOf(base.weather), {"clear", "overcast", "rain", "snow"}));
  conditions.wind_m_s = reader.real("wind_m_s", base.wind_m_s, 0.0, 30.0);
  conditions.world_seed = reader.integer("world_seed", base.world_seed, 0, 1000000);
  conditions.searchlight =
      searchlightOf(reader.choice("searchlight", nameOf(base.searchlight), {"auto", "on", "off"}));
  return conditions;
}

std::int64_t Conditions::day() const {
  return static_cast<std::int64_t>(std::floor(date_time_s / kSecondsPerDay));
}

double parseDateTime(const std::string& text) {
  const std::optional<double> seconds = parseUtc(text);
  if (!seconds || *seconds < 0.0) {
    throw ParameterError("parameter date_time is '" + text +
                         "', but must be a time from 1970 on such as 2026-06-21T11:00:00Z");
  }
  return *seconds;
}

std::string formatDateTime(double date_time_s) { return formatUtc(std::floor(date_time_s)); }

double dayOfYear(double date_time_s) {
  const double fraction = date_time_s / kSecondsPerDay - std::floor(date_time_s / kSecondsPerDay);
  return brokenDown(date_time_s).tm_yday + fraction;
}

}  // namespace perennial::park
