#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "perennial/core/drivers/tara_hid_codec.h"

struct hid_device_;

namespace perennial {

/// One hidraw node of the camera, through hidapi. Not thread-safe.
class TaraHid {
 public:
  /// Throws Error when it cannot be opened.
  explicit TaraHid(const std::string& path);

  /// Sends a request and waits for its reply; replies to others, as a late one to a request that timed out,
  /// are skipped.
  std::optional<TaraReply> ask(const TaraRequest& request, std::chrono::milliseconds timeout);
  bool send(const TaraRequest& request);
  enum class Outcome { kReply, kTimeout, kLost };
  Outcome read(std::chrono::milliseconds timeout, TaraReply& reply);

 private:
  struct Close {
    void operator()(hid_device_* device) const;
  };
  std::unique_ptr<hid_device_, Close> device_;
};

}  // namespace perennial
