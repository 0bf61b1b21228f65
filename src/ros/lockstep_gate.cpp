#include "perennial/ros/lockstep_gate.h"

#include <cstring>

namespace perennial {
namespace {

bool sameBits(double a, double b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

bool sameCommand(const geometry_msgs::Twist& a, const geometry_msgs::Twist& b) {
  return sameBits(a.linear.x, b.linear.x) && sameBits(a.angular.z, b.angular.z) &&
         sameBits(a.angular.y, b.angular.y);
}

}  // namespace

LockstepGate::LockstepGate(const std::vector<std::string>& nodes, bool through_drivers)
    : nodes_(nodes.begin(), nodes.end()), through_drivers_(through_drivers) {}

void LockstepGate::expect(const ros::Time& stamp) {
  last_stamp_ = stamp_;
  stamp_ = stamp;
  announced_.reset();
  pending_.clear();
  for (const std::string& node : nodes_) {
    if (absent_.count(node) == 0) {
      pending_.insert(node);
    }
  }
}

void LockstepGate::onProcessed(const perennial_nav::Processed& message) {
  if (nodes_.count(message.node) == 0) {
    return;
  }
  absent_.erase(message.node);
  if (!answers(message.header.stamp)) {
    return;  // a late answer to an image that was given up on
  }
  pending_.erase(message.node);
  if (message.has_command != 0 && !through_drivers_) {
    announced_ = message.command;
    announced_by_ = message.node;
  }
}

bool LockstepGate::answers(const ros::Time& stamp) const {
  return through_drivers_ ? stamp > last_stamp_ : stamp == stamp_;
}

void LockstepGate::onCommand(const geometry_msgs::Twist& command) { newest_ = command; }

std::vector<std::string> LockstepGate::missing() const {
  std::vector<std::string> result(pending_.begin(), pending_.end());
  if (announced_ && !(newest_ && sameCommand(*newest_, *announced_))) {
    result.push_back("the command of " + announced_by_);
  }
  return result;
}

void LockstepGate::giveUp() {
  absent_.insert(pending_.begin(), pending_.end());
  pending_.clear();
  announced_.reset();
}

}  // namespace perennial
