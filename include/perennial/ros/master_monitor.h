#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace perennial {

/// Watches the ROS master from a thread of its own, since asking a master that is gone may take long. Without
/// the master nobody new can stop a robot, nor see that it drives; a master that was restarted does not know
/// the nodes that were there before. Thread-safe; measured with the steady clock in simulated time too.
class MasterMonitor {
 public:
  explicit MasterMonitor(std::chrono::milliseconds timeout);
  ~MasterMonitor();
  MasterMonitor(const MasterMonitor&) = delete;
  MasterMonitor& operator=(const MasterMonitor&) = delete;

  /// Whether the master answered within the time-out.
  bool alive() const;
  /// Whether the master answers, but was restarted and knows nothing of this node: nobody can find it any
  /// more.
  bool forgotten() const;

 private:
  void watch();

  const std::chrono::milliseconds timeout_;
  mutable std::mutex mutex_;
  std::condition_variable ending_;
  bool end_ = false;
  bool known_ = false;  ///< the master has known this node
  bool forgotten_ = false;
  std::chrono::steady_clock::time_point last_answer_ = std::chrono::steady_clock::now();
  std::thread thread_;
};

}  // namespace perennial
