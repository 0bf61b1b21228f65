#pragma once

#include <optional>
#include <string>

namespace perennial {

/// Seconds since 1970-01-01T00:00:00Z of an ISO 8601 time: "2014-09-27T05:27:00Z", with a fraction of a
/// second
/// ("05:27:00.25Z") or an offset from UTC ("05:27:00+02:00"). None for anything else: a time without a zone,
/// a date that does not exist, text before or after it. Leap seconds (":60") do not exist in this count.
std::optional<double> parseUtc(const std::string& text);

/// The inverse, to the microsecond, fraction only where there is one: "2014-09-27T05:27:00Z". Years 0 to
/// 9999; throws Error for a stamp outside of them, or not finite.
std::string formatUtc(double stamp_s);

}  // namespace perennial
