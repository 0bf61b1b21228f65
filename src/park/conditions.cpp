#include "perennial/park/conditions.h"

#include <cmath>
#include <ctime>
#include <regex>

#include "perennial/core/error.h"

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
  static const std::regex kFormat(R"((\d{4})-(\d{2})-(\d{2})T(\d{2}):(\d{2})(?::(\d{2})(\.\d+)?)?Z?)");
  const std::string expected = "parameter date_time is '" + text +
                               "', but must be a UTC time from 1970 on such as 2026-06-21T11:00:00Z";
  std::smatch match;
  if (!std::regex_match(text, match, kFormat)) {
    throw ParameterError(expected);
  }
  const auto number = [&](std::size_t i) { return match[i].matched ? std::stoi(match[i].str()) : 0; };
  std::tm parts{};
  parts.tm_year = number(1) - 1900;
  parts.tm_mon = number(2) - 1;
  parts.tm_mday = number(3);
  parts.tm_hour = number(4);
  parts.tm_min = number(5);
  parts.tm_sec = number(6);
  const double fraction = match[7].matched ? std::stod("0" + match[7].str()) : 0.0;
  const double seconds = static_cast<double>(timegm(&parts)) + fraction;
  // timegm() normalises the 30th of February to the 2nd of March: a date that changed did not exist.
  const std::string again = seconds < 0.0 ? "" : formatDateTime(seconds);
  if (again.compare(0, 16, text, 0, 16) != 0 || number(6) > 59) {
    throw ParameterError(expected);
  }
  return seconds;
}

std::string formatDateTime(double date_time_s) {
  const std::tm parts = brokenDown(date_time_s);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

double dayOfYear(double date_time_s) {
  const double fraction = date_time_s / kSecondsPerDay - std::floor(date_time_s / kSecondsPerDay);
  return brokenDown(date_time_s).tm_yday + fraction;
}

}  // namespace perennial::park
