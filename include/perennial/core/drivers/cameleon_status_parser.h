#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "perennial/core/drivers/cameleon_codec.h"

namespace perennial {

/// Finds the status frames in the stream of bytes that the robot sends, one byte at a time and however the
/// stream is cut up. After noise, a half frame or a bad one it looks for the next header from the byte after
/// the last one on, so that the first whole frame that follows is found.
///
/// A frame with another type than 7, with a validity other than 0 and 1, or with an attitude, flipper
/// position or battery level that no robot has is dropped and counted. So is a frame that holds the beginning
/// of another one: its end was lost on the way. Not thread-safe; needs constant memory.
class CameleonStatusParser {
 public:
  struct Counters {
    std::uint64_t frames = 0;       ///< good ones
    std::uint64_t bad_frames = 0;   ///< a header, 29 bytes, and then not a status
    std::uint64_t stray_bytes = 0;  ///< bytes that belong to no good frame, those of bad frames included
  };

  /// Returns the status that this byte completes.
  std::optional<CameleonStatus> push(std::uint8_t byte);

  const Counters& counters() const { return counters_; }

  /// Forgets a frame that has begun: for a new connection. Keeps the counters.
  void reset();

 private:
  bool mayBeginFrame() const;
  void dropFirstByte();

  std::array<std::uint8_t, kCameleonStatusSize> buffer_{};
  std::size_t size_ = 0;
  Counters counters_;
};

}  // namespace perennial
