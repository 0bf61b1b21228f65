#include "perennial/ros/command_gate.h"

#include "perennial/ros/conversions.h"

namespace perennial {
namespace {

const ros::Duration kWatchPeriod(0.05);

}  // namespace

CommandGate::CommandGate(ros::NodeHandle nh, double timeout_s) : timeout_(timeout_s), spinner_(1, &queue_) {
  publisher_ = nh.advertise<geometry_msgs::Twist>("cmd_vel", 10);
  nh.setCallbackQueue(&queue_);
  timer_ = nh.createTimer(kWatchPeriod, [this](const ros::TimerEvent&) { watch(); });
  spinner_.start();
}

CommandGate::~CommandGate() {
  spinner_.stop();
  if (driving_) {
    send({});
  }
}

bool CommandGate::drive(const Velocity& velocity, const ros::Time& stamp) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool fresh = ros::Time::now() - stamp <= timeout_;
  driving_ = true;
  stamp_ = stamp;
  send(fresh ? velocity : Velocity{});
  return fresh;
}

void CommandGate::stop() {
  const std::lock_guard<std::mutex> lock(mutex_);
  driving_ = false;
  send({});
}

geometry_msgs::Twist CommandGate::newest() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return newest_;
}

void CommandGate::watch() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (driving_ && ros::Time::now() - stamp_ > timeout_) {
    send({});
  }
}

void CommandGate::send(const Velocity& velocity) {
  newest_ = toMessage(velocity);
  publisher_.publish(newest_);
}

}  // namespace perennial
