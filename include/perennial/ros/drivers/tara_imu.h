#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "perennial/ros/drivers/tara_hid.h"

namespace perennial {

/// Reads the camera's inertial sensor from its hidraw node, on a thread of its own. The camera is asked for
/// values once; should it then send only one report, it is asked for every further one.
class TaraImu {
 public:
  /// `callback` gets every report, on this object's thread. Throws Error when the node cannot be opened.
  TaraImu(const std::string& path, std::function<void(const TaraImuReading&)> callback);
  ~TaraImu();
  TaraImu(const TaraImu&) = delete;
  TaraImu& operator=(const TaraImu&) = delete;

  std::uint64_t badReports() const { return bad_reports_; }

 private:
  void work();

  TaraHid hid_;
  std::function<void(const TaraImuReading&)> callback_;
  std::atomic<bool> end_{false};
  std::atomic<std::uint64_t> bad_reports_{0};
  std::thread thread_;
};

}  // namespace perennial
