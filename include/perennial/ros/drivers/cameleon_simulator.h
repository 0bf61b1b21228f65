#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "perennial/core/drivers/cameleon_robot.h"
#include "perennial/core/parameter_reader.h"
#include "perennial/ros/drivers/cameleon_faults.h"
#include "perennial/ros/drivers/cameleon_server.h"
#include "perennial/ros/drivers/clock_publisher.h"
#include "perennial/ros/drivers/tick_timer.h"
#include "perennial_nav/InjectFault.h"

namespace perennial {

struct CameleonSimulatorSettings {
  int port = 50004;
  std::string bind_address = "127.0.0.1";  ///< to listen on; "0.0.0.0": all of the computer's
  double track_distance_m = 0.40;
  CameleonScale scale;
  int battery_percent = 80;
  bool external_body = false;  ///< another simulation moves the body: see CameleonSimulator
  bool publish_clock = false;  ///< the simulator's time is everybody's (/clock)
  double clock_rate = 1.0;     ///< simulated seconds per second, with publish_clock

  static CameleonSimulatorSettings load(ParameterReader& reader);
};

/// A CAMELEON E on the wire: listens where the robot listens, speaks its protocol with its timing, and
/// misbehaves on demand (service `~inject_fault`).
///
/// Publishes `~state` once per loop: what the robot does, as nav_msgs/Odometry, stamped with the robot's own
/// time (its loops). With `external_body` it publishes the velocity it was told as `body_cmd_vel`, and counts
/// its tracks by `body_odom`: the body is then that of another simulation. Everything runs on the spinning
/// thread.
class CameleonSimulator {
 public:
  CameleonSimulator(ros::NodeHandle nh, ros::NodeHandle private_nh,
                    const CameleonSimulatorSettings& settings);

 private:
  /// Bytes or commands that are on their way.
  template <typename Cargo>
  using Delayed = std::deque<std::pair<double, Cargo>>;

  /// One loop of the robot: called every CameleonRobot::kLoopPeriod_s.
  void loop();
  bool injectFault(perennial_nav::InjectFault::Request& request,
                   perennial_nav::InjectFault::Response& response);
  void defineFaults();
  void receive(double now_s);
  void moveBody(const Velocity& velocity);
  void onBodyOdometry(const nav_msgs::Odometry& odometry);
  void sendStatus(double now_s);
  void publishState();

  const CameleonSimulatorSettings settings_;
  CameleonServer server_;
  CameleonRobot robot_;
  CameleonFaults faults_;
  std::map<std::string, std::function<void(double value, double now_s)>> fault_setters_;
  std::mt19937 random_{1};
  Delayed<CameleonCommand> commands_;
  Delayed<std::vector<std::uint8_t>> statuses_;
  double loop_time_s_ = 0.0;  ///< goes on while the robot's program is frozen
  double x_m_ = 0.0;
  double y_m_ = 0.0;
  double yaw_rad_ = 0.0;
  struct BodyPose {
    double x_m;
    double y_m;
    double yaw_rad;
  };
  std::optional<BodyPose> body_;
  ros::Publisher state_publisher_;
  ros::Publisher body_command_publisher_;
  ros::Subscriber body_subscriber_;
  ros::ServiceServer fault_service_;
  std::unique_ptr<ClockPublisher> clock_;
  std::unique_ptr<TickTimer> timer_;
};

}  // namespace perennial
