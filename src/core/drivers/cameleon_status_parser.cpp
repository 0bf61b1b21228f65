#include "perennial/core/drivers/cameleon_status_parser.h"

#include <algorithm>
#include <cstdlib>

namespace perennial {
namespace {

constexpr std::array<std::uint8_t, kCameleonStatusHeaderSize> kHeader = {0xF0, 0xAF, 0xFA};
constexpr std::uint8_t kStatusType = 7;

/// No angle or battery level of a robot lies beyond these. They are wide on purpose, just tight enough that a
/// frame which lost its end, and is filled up with the first bytes of the next one, does not pass.
constexpr std::int32_t kMaxAngleDeg = 3600;
constexpr std::int32_t kMinBatteryPercent = -1;
constexpr std::int32_t kMaxBatteryPercent = 127;

std::int32_t integer(const std::uint8_t* bytes) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 4; ++i) {
    bits = (bits << 8) | bytes[i];
  }
  return static_cast<std::int32_t>(bits);
}

bool isAngle(std::int32_t degrees) { return degrees >= -kMaxAngleDeg && degrees <= kMaxAngleDeg; }

/// Header, type and validity of a status: the part of a frame that hardly varies.
bool beginsStatus(const std::uint8_t* bytes) {
  const std::uint8_t* validity = bytes + 4;
  return std::equal(kHeader.begin(), kHeader.end(), bytes) && bytes[3] == kStatusType && validity[0] == 0 &&
         validity[1] == 0 && validity[2] == 0 && validity[3] <= 1;
}

bool holdsAnotherBeginning(const CameleonStatusBytes& frame) {
  constexpr std::size_t kBeginningSize = 8;
  for (std::size_t i = kBeginningSize; i + kBeginningSize <= frame.size(); ++i) {
    if (beginsStatus(&frame[i])) {
      return true;
    }
  }
  return false;
}

std::optional<CameleonStatus> decode(const CameleonStatusBytes& frame) {
  if (!beginsStatus(frame.data()) || holdsAnotherBeginning(frame)) {
    return std::nullopt;
  }
  const CameleonStatus status{frame[7] == 1,       integer(&frame[8]),  integer(&frame[12]),
                              integer(&frame[16]), integer(&frame[20]), integer(&frame[24]),
                              integer(&frame[28])};
  const bool plausible = isAngle(status.pitch_deg) && isAngle(status.roll_deg) &&
                         isAngle(status.flipper_deg) && status.battery_percent >= kMinBatteryPercent &&
                         status.battery_percent <= kMaxBatteryPercent;
  return plausible ? std::optional<CameleonStatus>(status) : std::nullopt;
}

}  // namespace

std::optional<CameleonStatus> CameleonStatusParser::push(std::uint8_t byte) {
  buffer_[size_++] = byte;
  while (size_ > 0 && !mayBeginFrame()) {
    dropFirstByte();
  }
  if (size_ < kCameleonStatusSize) {
    return std::nullopt;
  }
  if (const std::optional<CameleonStatus> status = decode(buffer_)) {
    ++counters_.frames;
    size_ = 0;
    return status;
  }
  ++counters_.bad_frames;
  do {
    dropFirstByte();
  } while (size_ > 0 && !mayBeginFrame());
  return std::nullopt;
}

void CameleonStatusParser::reset() {
  counters_.stray_bytes += size_;
  size_ = 0;
}

bool CameleonStatusParser::mayBeginFrame() const {
  const auto compared = static_cast<std::ptrdiff_t>(std::min(size_, kHeader.size()));
  return std::equal(kHeader.begin(), kHeader.begin() + compared, buffer_.begin());
}

void CameleonStatusParser::dropFirstByte() {
  std::copy(buffer_.begin() + 1, buffer_.begin() + static_cast<std::ptrdiff_t>(size_), buffer_.begin());
  --size_;
  ++counters_.stray_bytes;
}

}  // namespace perennial
