#pragma once

#include <cstdint>
#include <optional>

namespace perennial {

/// Notices that the sender of a stream of messages was started anew, by the numbers that each sender counts from
/// its own start. What such a sender measures since then, the way of an odometry, does not continue what the one
/// before has measured. Numbers may be left out and may wrap; a sender that does not count is never noticed.
class RestartWatch {
 public:
  /// Whether a message with this number comes from a sender that was started after the last message.
  bool restarted(std::uint32_t number) {
    const bool back = last_ && static_cast<std::int32_t>(number - *last_) < 0;
    last_ = number;
    return back;
  }
  void reset() { last_.reset(); }

 private:
  std::optional<std::uint32_t> last_;
};

}  // namespace perennial
