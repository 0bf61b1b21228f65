#include "perennial/ros/master_monitor.h"

#include <ros/master.h>
#include <ros/this_node.h>

namespace perennial {
namespace {

/// Whether the master has an address of this node.
bool knowsThisNode() {
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  request[1] = ros::this_node::getName();
  return ros::master::execute("lookupNode", request, response, payload, false);
}

}  // namespace

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

bool MasterMonitor::forgotten() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return forgotten_;
}

void MasterMonitor::watch() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!end_) {
    lock.unlock();
    const bool known = knowsThisNode();
    // Not known, and yet the master answers: asked in this order, a master that dies in between is not
    // mistaken for a new one.
    const bool answers = known || ros::master::check();
    lock.lock();
    if (answers) {
      last_answer_ = std::chrono::steady_clock::now();
    }
    forgotten_ = forgotten_ || (known_ && answers && !known);
    known_ = known_ || known;
    ending_.wait_for(lock, timeout_ / 4, [this] { return end_; });
  }
}

}  // namespace perennial
