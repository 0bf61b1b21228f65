#pragma once

#include <atomic>
#include <mutex>
#include <random>
#include <thread>

#include "perennial/core/drivers/tara_device.h"
#include "perennial/ros/drivers/tara_world.h"

namespace perennial {

/// The camera's two hidraw nodes, for tara_preload: socket pairs whose far ends answer as a TaraDevice does,
/// or as its faults demand. Its thread runs as long as the process.
class TaraSimulatedHid {
 public:
  explicit TaraSimulatedHid(TaraWorld& world);

  /// A new descriptor of the control or the IMU node; the one handed out before goes dead.
  int openControl();
  int openImu();

 private:
  int open(std::atomic<int>& far_end);
  void run();
  void serve(std::atomic<int>& far_end, bool is_imu);
  void streamImu();
  void reply(int far_end, TaraReply report);

  TaraWorld& world_;
  TaraDevice device_;
  std::mt19937 random_{1};
  std::atomic<int> control_{-1};
  std::atomic<int> imu_{-1};
  bool imu_asked_ = false;
  double next_report_s_ = 0.0;
  std::thread thread_;
};

}  // namespace perennial
