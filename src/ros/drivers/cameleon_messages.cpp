#include "perennial/ros/drivers/cameleon_messages.h"

#include <tf2/LinearMath/Quaternion.h>
#include <tf2_geometry_msgs/tf2_geometry_msgs.h>

#include <cmath>
#include <limits>

namespace perennial {
namespace {

constexpr double kRadiansPerDegree = 0.017453292519943295;
constexpr double kUnmeasured = 1e6;
constexpr double kFixed = 1e-9;
/// The inclinometer resolves one degree.
constexpr double kInclinationVariance = kRadiansPerDegree * kRadiansPerDegree;

}  // namespace

nav_msgs::Odometry toOdometry(const OdometryState& state, const CameleonStatus& status,
                              const CameleonFrames& frames, const ros::Time& stamp) {
  nav_msgs::Odometry message;
  message.header.stamp = stamp;
  message.header.frame_id = frames.odom;
  message.child_frame_id = frames.base;
  message.pose.pose.position.x = state.x_m;
  message.pose.pose.position.y = state.y_m;
  tf2::Quaternion orientation;
  orientation.setRPY(status.roll_deg * kRadiansPerDegree, status.pitch_deg * kRadiansPerDegree,
                     state.yaw_rad);
  message.pose.pose.orientation = tf2::toMsg(orientation);
  const int rows[3] = {0, 1, 5};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      message.pose.covariance[static_cast<std::size_t>(6 * rows[row] + rows[column])] =
          state.pose_covariance(row, column);
    }
  }
  message.pose.covariance[14] = kUnmeasured;
  message.pose.covariance[21] = kInclinationVariance;
  message.pose.covariance[28] = kInclinationVariance;
  message.twist.twist.linear.x = state.forward_mps;
  message.twist.twist.angular.z = state.angular_radps;
  message.twist.covariance[0] = state.twist_covariance(0, 0);
  message.twist.covariance[7] = kFixed;
  message.twist.covariance[14] = kUnmeasured;
  message.twist.covariance[21] = kUnmeasured;
  message.twist.covariance[28] = kUnmeasured;
  message.twist.covariance[35] = state.twist_covariance(1, 1);
  return message;
}

sensor_msgs::BatteryState toBatteryState(const CameleonStatus& status, const ros::Time& stamp) {
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  sensor_msgs::BatteryState message;
  message.header.stamp = stamp;
  message.voltage = unknown;
  message.current = unknown;
  message.charge = unknown;
  message.capacity = unknown;
  message.design_capacity = unknown;
  message.percentage = static_cast<float>(status.battery_percent) / 100.0F;
  message.power_supply_status = sensor_msgs::BatteryState::POWER_SUPPLY_STATUS_DISCHARGING;
  message.present = true;
  return message;
}

sensor_msgs::JointState toJointState(const CameleonStatus& status, const CameleonFrames& frames,
                                     const ros::Time& stamp) {
  sensor_msgs::JointState message;
  message.header.stamp = stamp;
  message.name.push_back(frames.flipper_joint);
  message.position.push_back(status.flipper_deg * kRadiansPerDegree);
  return message;
}

}  // namespace perennial
