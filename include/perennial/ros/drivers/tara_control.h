#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "perennial/ros/drivers/tara_hid.h"

namespace perennial {

/// The camera's control node, on a thread of its own: a reply may take two seconds, which must not hold up
/// the images. Of several exposures or set-ups that are asked for meanwhile only the newest is set. A request
/// that fails is counted and made again once. All methods are thread-safe.
class TaraControl {
 public:
  explicit TaraControl(const std::string& path);
  ~TaraControl();
  TaraControl(const TaraControl&) = delete;
  TaraControl& operator=(const TaraControl&) = delete;

  void setExposure(std::uint32_t exposure);
  void setImu(const TaraImuSetup& setup);

  struct State {
    std::optional<TaraFirmware> firmware;
    std::optional<std::uint32_t> unique_id;
    std::optional<std::uint32_t> exposure;  ///< the camera has confirmed
    /// The camera has confirmed, and streams accordingly; nothing while a new set-up is on its way.
    std::optional<TaraImuSetup> imu;
    std::chrono::steady_clock::time_point imu_since;
    std::uint64_t failures = 0;
  };
  State state() const;

 private:
  void work();
  void identify();
  bool applyExposure(std::uint32_t exposure);
  bool applyImu(const TaraImuSetup& setup);
  /// The reply, or nothing and a failure counted.
  std::optional<TaraReply> ask(const TaraRequest& request);

  TaraHid hid_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool end_ = false;
  std::optional<std::uint32_t> wanted_exposure_;
  std::optional<TaraImuSetup> wanted_imu_;
  State state_;
  std::thread thread_;
};

}  // namespace perennial
