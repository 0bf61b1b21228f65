#pragma once

#include <cstdio>
#include <string>

namespace perennial {

/// A number with its unit, short enough for a person to read while a robot stands.
inline std::string humanNumber(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.1f %s", value, unit);
  return text;
}
inline std::string humanSeconds(double value) { return humanNumber(value, "s"); }
inline std::string humanMetres(double value) { return humanNumber(value, "m"); }
/// `share`: 0 to 1.
inline std::string humanPercent(double share) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.0f %%", 100.0 * share);
  return text;
}

}  // namespace perennial
