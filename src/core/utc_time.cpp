#include "perennial/core/utc_time.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <regex>

#include "perennial/core/error.h"

namespace perennial {
namespace {

constexpr std::int64_t kSecondsPerDay = 86400;
constexpr std::int64_t kMicroseconds = 1000000;

bool isLeapYear(std::int64_t year) { return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0); }

std::int64_t daysInMonth(std::int64_t year, std::int64_t month) {
  constexpr int kDays[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  return kDays[month - 1] + (month == 2 && isLeapYear(year) ? 1 : 0);
}

/// Days from 0000-01-01 to the first day of a year, in the Gregorian calendar carried back.
std::int64_t daysBeforeYear(std::int64_t year) {
  const std::int64_t last = year - 1;
  return year == 0 ? 0 : 365 * year + last / 4 - last / 100 + last / 400 + 1;  // year 0 was a leap year
}

std::int64_t daysSince1970(std::int64_t year, std::int64_t month, std::int64_t day) {
  std::int64_t days = daysBeforeYear(year) - daysBeforeYear(1970) + day - 1;
  for (std::int64_t m = 1; m < month; ++m) {
    days += daysInMonth(year, m);
  }
  return days;
}

}  // namespace

std::optional<double> parseUtc(const std::string& text) {
  static const std::regex kPattern(
      R"((\d{4})-(\d\d)-(\d\d)T(\d\d):(\d\d):(\d\d)(\.\d{1,9})?(?:Z|([+-])(\d\d):(\d\d)))");
  std::smatch match;
  if (!std::regex_match(text, match, kPattern)) {
    return std::nullopt;
  }
  const auto number = [&](std::size_t group) { return std::int64_t{std::stoi(match[group].str())}; };
  const std::int64_t month = number(2);
  const std::int64_t day = number(3);
  if (month < 1 || month > 12 || day < 1 || day > daysInMonth(number(1), month) || number(4) > 23 ||
      number(5) > 59 || number(6) > 59) {
    return std::nullopt;
  }
  std::int64_t seconds =
      daysSince1970(number(1), month, day) * kSecondsPerDay + number(4) * 3600 + number(5) * 60 + number(6);
  if (match[8].matched) {
    const std::int64_t offset = number(9) * 3600 + number(10) * 60;
    seconds -= match[8].str() == "+" ? offset : -offset;
  }
  const double fraction = match[7].matched ? std::stod("0" + match[7].str()) : 0.0;
  return static_cast<double>(seconds) + fraction;
}

std::string formatUtc(double stamp_s) {
  const double first = static_cast<double>(daysSince1970(0, 1, 1) * kSecondsPerDay);
  const double end = static_cast<double>(daysSince1970(10000, 1, 1) * kSecondsPerDay);
  if (!(stamp_s >= first && stamp_s < end - 1.0)) {
    throw Error("the time " + std::to_string(stamp_s) + " s since 1970 lies outside of the years 0 to 9999");
  }
  const std::int64_t since_year_0 =
      std::llround((stamp_s - std::floor(stamp_s)) * 1e6) +
      (static_cast<std::int64_t>(std::floor(stamp_s)) - static_cast<std::int64_t>(first)) * kMicroseconds;
  std::int64_t day = since_year_0 / kMicroseconds / kSecondsPerDay;
  std::int64_t year = day / 366;  // never too late: no year is longer
  while (day >= daysBeforeYear(year + 1)) {
    ++year;
  }
  day -= daysBeforeYear(year);
  std::int64_t month = 1;
  while (day >= daysInMonth(year, month)) {
    day -= daysInMonth(year, month++);
  }
  const std::int64_t second = since_year_0 / kMicroseconds % kSecondsPerDay;
  const std::int64_t fraction = since_year_0 % kMicroseconds;
  char text[64];
  std::snprintf(text, sizeof(text), "%04lld-%02lld-%02lldT%02lld:%02lld:%02lld", static_cast<long long>(year),
                static_cast<long long>(month), static_cast<long long>(day + 1),
                static_cast<long long>(second / 3600), static_cast<long long>(second / 60 % 60),
                static_cast<long long>(second % 60));
  std::string result = text;
  if (fraction != 0) {
    std::snprintf(text, sizeof(text), ".%06lld", static_cast<long long>(fraction));
    result += text;
  }
  return result + "Z";
}

}  // namespace perennial
