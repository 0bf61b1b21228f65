#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/Twist.h>
#include <ros/node_handle.h>
#include <std_msgs/Bool.h>
#include <tf2_ros/transform_broadcaster.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "perennial/core/drivers/motion_gate.h"
#include "perennial/core/drivers/track_odometry.h"
#include "perennial/ros/drivers/cameleon_link.h"
#include "perennial/ros/drivers/cameleon_messages.h"
#include "perennial/ros/drivers/tick_timer.h"
#include "perennial/ros/master_monitor.h"

namespace perennial {

struct CameleonDriverSettings {
  CameleonLinkSettings link;
  CameleonScale scale;
  VelocityLimits limits;
  TrackOdometrySettings odometry;
  CameleonFrames frames;
  double command_rate_hz = 20.0;   ///< the robot takes one command per loop of 40 ms
  double command_timeout_s = 0.5;  ///< the robot stops when no cmd_vel came for so long
  double command_settle_s = 0.2;   ///< after a pause, cmd_vel must have been coming for so long to be obeyed
  double status_timeout_s = 0.5;   ///< a robot that is silent for so long is connected to anew
  double master_timeout_s = 2.0;   ///< the robot stops when the ROS master has been gone for so long
  double battery_low_percent = 20.0;
  bool publish_tf = true;

  static CameleonDriverSettings load(ParameterReader& reader);
};

/// Drives the CAMELEON E: `cmd_vel` and `emergency_stop` in, `odom`, `battery`, `joint_states`, tf and
/// diagnostics out.
///
/// Callbacks and timer run on the node's spinning thread, what comes from the robot on the link's; a mutex
/// guards what both use. MotionGate decides when the robot must stand still.
class CameleonDriver {
 public:
  CameleonDriver(ros::NodeHandle nh, ros::NodeHandle private_nh, const CameleonDriverSettings& settings);
  /// Stops the robot.
  ~CameleonDriver();

 private:
  void onCommand(const geometry_msgs::Twist& twist);
  void onEmergencyStop(const std_msgs::Bool& engaged);
  void onStatus(const CameleonStatus& status);
  void onConnection(bool connected);
  void tick();
  void publish(const CameleonStatus& status, const OdometryState& odometry, const ros::Time& stamp);
  void diagnoseConnection(diagnostic_updater::DiagnosticStatusWrapper& report);
  void diagnoseRobot(diagnostic_updater::DiagnosticStatusWrapper& report);

  const CameleonDriverSettings settings_;
  ros::Publisher odometry_publisher_;
  ros::Publisher battery_publisher_;
  ros::Publisher joint_publisher_;
  tf2_ros::TransformBroadcaster transform_broadcaster_;

  std::mutex mutex_;  ///< guards what follows, down to the next blank line
  MotionGate gate_;
  TrackOdometry odometry_;
  bool connected_ = false;
  std::optional<CameleonStatus> last_status_;
  double last_status_s_ = 0.0;
  double last_tick_s_ = 0.0;
  std::uint64_t invalid_statuses_ = 0;
  std::uint64_t refused_commands_ = 0;

  double rate_since_s_ = 0.0;
  std::uint64_t rate_frames_ = 0;
  diagnostic_updater::Updater diagnostics_;
  MasterMonitor master_;
  std::unique_ptr<CameleonLink> link_;  ///< after everything that its callbacks use
  ros::Subscriber command_subscriber_;
  ros::Subscriber emergency_stop_subscriber_;
  std::unique_ptr<TickTimer> timer_;
};

}  // namespace perennial
