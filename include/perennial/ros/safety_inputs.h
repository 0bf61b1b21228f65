#pragma once

#include <geometry_msgs/Twist.h>
#include <ros/ros.h>
#include <sensor_msgs/Joy.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/Range.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Empty.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include "perennial/ros/command_gate.h"

namespace perennial {

/// What people and sensors say about moving, handed to the command gate by the gate's own thread.
///
/// Always: topic e_stop (std_msgs/Bool, latched by whoever sends it), services e_stop (std_srvs/SetBool) and
/// resume (std_srvs/Trigger), topic teleop_vel (geometry_msgs/Twist). As the settings say: joy or heartbeat
/// (std_msgs/Empty); obstacle_range, obstacle_scan, obstacle. The gate must outlive it.
class SafetyInputs {
 public:
  SafetyInputs(CommandGate& gate, const InterlockSettings& settings);

 private:
  bool onStopService(std_srvs::SetBoolRequest& request, std_srvs::SetBoolResponse& response);
  bool onResume(std_srvs::TriggerRequest& request, std_srvs::TriggerResponse& response);
  void onJoy(const sensor_msgs::Joy& joy);
  void onRange(const sensor_msgs::Range& range);
  void onScan(const sensor_msgs::LaserScan& scan);
  void subscribeDeadMan(ros::NodeHandle nh);
  void subscribeObstacles(ros::NodeHandle nh);

  CommandGate& gate_;
  InterlockSettings settings_;
  std::vector<ros::Subscriber> subscribers_;
  ros::ServiceServer stop_server_;
  ros::ServiceServer resume_server_;
};

}  // namespace perennial
