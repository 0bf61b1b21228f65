#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/time.h>
#include <sensor_msgs/BatteryState.h>
#include <sensor_msgs/JointState.h>

#include <string>

#include "perennial/core/drivers/cameleon_codec.h"
#include "perennial/core/drivers/track_odometry.h"

/// Conversions from what the robot says to ROS messages.
namespace perennial {

struct CameleonFrames {
  std::string odom = "odom";
  std::string base = "base_link";
  std::string flipper_joint = "flipper_joint";
};

/// Planar pose, with roll and pitch from the robot's inclinometer in the orientation. Axes that the tracks do
/// not measure get a tiny variance when the robot cannot move along them, and a large one when nobody knows.
nav_msgs::Odometry toOdometry(const OdometryState& state, const CameleonStatus& status,
                              const CameleonFrames& frames, const ros::Time& stamp);

sensor_msgs::BatteryState toBatteryState(const CameleonStatus& status, const ros::Time& stamp);

/// Position of the flippers, rad.
sensor_msgs::JointState toJointState(const CameleonStatus& status, const CameleonFrames& frames,
                                     const ros::Time& stamp);

}  // namespace perennial
