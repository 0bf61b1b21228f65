#include "perennial/ros/drivers/master_monitor.h"

#include <ros/master.h>

namespace perennial {

MasterMonitor::MasterMonitor(std::chrono::milliseconds timeout)
    : timeout_(timeout), thread_([this] { watch(); }) {}

MasterMonitor::~MasterMonitor() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  ending_.notify_all();
  thread_.join();
}

bool MasterMonitor::alive() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::chrono::steady_clock::now() - last_answer_ <= timeout_;
}

void MasterMonitor::watch() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!end_) {
    lock.unlock();
    const bool answers = ros::master::check();
    lock.lock();
    if (answers) {
      last_answer_ = std::chrono::steady_clock::now();
    }
    ending_.wait_for(lock, timeout_ / 4, [this] { return end_; });
  }
}

}  // namespace perennial
