#include "perennial/ros/drivers/cameleon_faults.h"

#include <algorithm>

namespace perennial {

std::vector<std::uint8_t> CameleonFaults::distort(const CameleonStatus& status, std::mt19937& random) {
  CameleonStatusBytes frame = encode(status);
  if (wrong_types > 0) {
    --wrong_types;
    frame[3] = 6;
  }
  if (wrong_validities > 0) {
    --wrong_validities;
    frame[7] = 2;
  }
  std::vector<std::uint8_t> bytes;
  for (; stray_bytes > 0; --stray_bytes) {
    bytes.push_back(static_cast<std::uint8_t>(random()));
  }
  const auto whole = static_cast<std::ptrdiff_t>(frame.size());
  const std::ptrdiff_t kept =
      half_frame_bytes > 0 ? std::min<std::ptrdiff_t>(half_frame_bytes, whole) : whole;
  half_frame_bytes = 0;
  bytes.insert(bytes.end(), frame.begin(), frame.begin() + kept);
  return bytes;
}

}  // namespace perennial
