#include "perennial/ros/drivers/tara_hid.h"

#include <hidapi/hidapi.h>

#include "perennial/core/error.h"

namespace perennial {

void TaraHid::Close::operator()(hid_device_* device) const { hid_close(device); }

TaraHid::TaraHid(const std::string& path) : device_(hid_open_path(path.c_str())) {
  if (!device_) {
    throw Error(path + ": cannot be opened as an HID device; see the udev rules in docs/hardware.md");
  }
}

std::optional<TaraReply> TaraHid::ask(const TaraRequest& request, std::chrono::milliseconds timeout) {
  if (!send(request)) {
    return std::nullopt;
  }
  const auto end = std::chrono::steady_clock::now() + timeout;
  TaraReply reply;
  for (auto left = timeout; left.count() > 0;
       left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now())) {
    if (read(left, reply) != Outcome::kReply) {
      return std::nullopt;
    }
    if (answers(reply, request)) {
      return reply;
    }
  }
  return std::nullopt;
}

bool TaraHid::send(const TaraRequest& request) {
  return hid_write(device_.get(), request.data(), request.size()) > 0;
}

TaraHid::Outcome TaraHid::read(std::chrono::milliseconds timeout, TaraReply& reply) {
  reply.resize(kTaraReplySize);
  const int size =
      hid_read_timeout(device_.get(), reply.data(), reply.size(), static_cast<int>(timeout.count()));
  reply.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  if (size < 0) {
    return Outcome::kLost;
  }
  return size == 0 ? Outcome::kTimeout : Outcome::kReply;
}

}  // namespace perennial
