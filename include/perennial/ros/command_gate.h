#pragma once

#include <mutex>

#include <geometry_msgs/Twist.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "perennial/core/path_profile.h"

namespace perennial {

/// The only way to the robot: publishes commands, and stops the robot by itself when no fresh command follows, even
/// while the node's other callbacks are busy. Thread-safe; watches in a thread of its own, by ROS time.
class CommandGate {
 public:
  /// A command is fresh for `timeout_s` after the stamp of the data it was computed from.
  CommandGate(ros::NodeHandle nh, double timeout_s);
  /// Stops the robot if it was being driven.
  ~CommandGate();

  /// Sends a velocity computed from data of this stamp. Sends zero instead, and returns false, when the data is stale.
  bool drive(const Velocity& velocity, const ros::Time& stamp);
  /// Sends zero, once, and stops watching.
  void stop();

  /// The newest command sent.
  geometry_msgs::Twist newest() const;

 private:
  void watch();
  void send(const Velocity& velocity);

  const ros::Duration timeout_;
  mutable std::mutex mutex_;
  bool driving_ = false;
  ros::Time stamp_;
  geometry_msgs::Twist newest_;
  ros::Publisher publisher_;
  ros::CallbackQueue queue_;
  ros::Timer timer_;
  ros::AsyncSpinner spinner_;
};

}  // namespace perennial
