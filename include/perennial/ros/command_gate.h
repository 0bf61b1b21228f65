#pragma once

#include <geometry_msgs/Twist.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <mutex>
#include <string>

#include "perennial/core/drivers/velocity_limiter.h"
#include "perennial/core/motion_interlock.h"
#include "perennial/core/path_profile.h"
#include "perennial/ros/master_monitor.h"

namespace perennial {

/// The only way to the robot, and the last: enforces the limits of speed, acceleration and turn rate and
/// whatever the interlock forbids, publishes commands, and stops the robot by itself when no fresh command
/// follows, even while the node's other callbacks are busy. Thread-safe; watches in a thread of its own, by
/// ROS time.
///
/// A stop is zero at once, without gentle braking; a hold brakes as the limits say. A person's commands pass
/// whether or not anybody else drives.
class CommandGate {
 public:
  /// A command is fresh for `timeout_s` after the stamp of the data it was computed from.
  CommandGate(ros::NodeHandle nh, double timeout_s, const VelocityLimits& limits,
              const InterlockSettings& interlock);
  /// Stops the robot if it was being driven.
  ~CommandGate();

  /// A repeat begins: commands of strangers and people from before do not matter.
  void begin();
  /// Sends a velocity computed from data of this stamp, as far as the limits and the interlock allow. Sends
  /// zero instead, and returns false, when the data is stale.
  bool drive(const Velocity& velocity, const ros::Time& stamp);
  /// Sends zero now, and goes on watching: the next fresh command drives again.
  void halt();
  /// Sends zero, once, and stops watching.
  void stop();

  /// The newest command sent.
  geometry_msgs::Twist newest() const;
  /// What the interlock says now.
  MotionPermit permit() const;

  // What SafetyInputs hears; acts at once. A stamp is the message's own: late ones do not count as news.
  // Zero: it has none, and counts from its arrival.
  void setEmergencyStop(EmergencyStop source, bool engaged);
  void latchEmergencyStop();
  bool emergencyStopped() const;
  bool resume();
  void deadMan(bool held, const ros::Time& stamp);
  void obstacle(ObstacleSensor sensor, double distance_m, const ros::Time& stamp);
  void teleop(const Velocity& velocity);

  /// Served by the gate's own thread: safety must not wait for an image that is being registered.
  ros::NodeHandle nodeHandle() const { return nh_; }

 private:
  void onCommand(const ros::MessageEvent<const geometry_msgs::Twist>& event);
  void watch();
  bool fresh(const ros::Time& now) const;
  /// Under the mutex: applies a change to the interlock and lets the robot feel it at once.
  template <typename Change>
  void change(const Change& apply);
  void enforce();
  /// Brakes for an obstacle, by the time since the newest command, whoever sent that.
  void hold(const ros::Time& now);
  void approachAndSend(const Velocity& wanted, double elapsed_s);
  void send(const Velocity& velocity);

  const ros::Duration timeout_;
  const VelocityLimits limits_;
  ros::CallbackQueue queue_;
  ros::NodeHandle nh_;
  mutable std::mutex mutex_;
  MotionInterlock interlock_;
  bool driving_ = false;
  bool by_hand_ = false;
  ros::Time stamp_;    ///< of the data that the newest command was computed from
  ros::Time sent_;     ///< when the newest command left
  Velocity velocity_;  ///< the newest one sent
  geometry_msgs::Twist newest_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  MasterMonitor master_;
  ros::Timer timer_;
  ros::AsyncSpinner spinner_;
};

}  // namespace perennial
