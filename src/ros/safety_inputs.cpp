#include "perennial/ros/safety_inputs.h"

#include <cmath>
#include <limits>

#include "perennial/ros/conversions.h"

namespace perennial {
namespace {

constexpr double kNothing_m = std::numeric_limits<double>::infinity();

/// As REP 117 has it: -inf is too near to measure, +inf or beyond the range is nothing, NaN is a reading that
/// failed. Without a max_range everything would be beyond it: such a message says nothing, either.
double distanceOf(const sensor_msgs::Range& range) {
  const double distance_m = range.range;
  if (std::isnan(distance_m) || !(range.max_range > 0.0F)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return distance_m > range.max_range ? kNothing_m : std::max(distance_m, 0.0);
}

}  // namespace

SafetyInputs::SafetyInputs(CommandGate& gate, const InterlockSettings& settings)
    : gate_(gate), settings_(settings) {
  ros::NodeHandle nh = gate_.nodeHandle();
  subscribers_.push_back(
      nh.subscribe<std_msgs::Bool>("e_stop", 10, [this](const std_msgs::BoolConstPtr& message) {
        gate_.setEmergencyStop(EmergencyStop::kTopic, message->data != 0);
      }));
  subscribers_.push_back(nh.subscribe<geometry_msgs::Twist>(
      "teleop_vel", 10,
      [this](const geometry_msgs::TwistConstPtr& message) { gate_.teleop(fromMessage(*message)); }));
  stop_server_ = nh.advertiseService("e_stop", &SafetyInputs::onStopService, this);
  resume_server_ = nh.advertiseService("resume", &SafetyInputs::onResume, this);
  subscribeDeadMan(nh);
  subscribeObstacles(nh);
}

void SafetyInputs::subscribeDeadMan(ros::NodeHandle nh) {
  if (settings_.dead_man.kind == DeadManSettings::Kind::kJoy) {
    subscribers_.push_back(nh.subscribe("joy", 10, &SafetyInputs::onJoy, this));
  } else if (settings_.dead_man.kind == DeadManSettings::Kind::kHeartbeat) {
    subscribers_.push_back(nh.subscribe<std_msgs::Empty>(
        "heartbeat", 10, [this](const std_msgs::EmptyConstPtr&) { gate_.deadMan(true, {}); }));
  }
}

void SafetyInputs::subscribeObstacles(ros::NodeHandle nh) {
  if (settings_.obstacles.range) {
    subscribers_.push_back(nh.subscribe("obstacle_range", 10, &SafetyInputs::onRange, this));
  }
  if (settings_.obstacles.scan) {
    subscribers_.push_back(nh.subscribe("obstacle_scan", 10, &SafetyInputs::onScan, this));
  }
  if (settings_.obstacles.flag) {
    subscribers_.push_back(
        nh.subscribe<std_msgs::Bool>("obstacle", 10, [this](const std_msgs::BoolConstPtr& message) {
          gate_.obstacle(ObstacleSensor::kFlag, message->data != 0 ? 0.0 : kNothing_m, {});
        }));
  }
}

bool SafetyInputs::onStopService(std_srvs::SetBoolRequest& request, std_srvs::SetBoolResponse& response) {
  gate_.setEmergencyStop(EmergencyStop::kService, request.data != 0);
  response.success = true;
  response.message = request.data != 0 ? "the robot is stopped" : "released; call resume to go on";
  return true;
}

bool SafetyInputs::onResume(std_srvs::TriggerRequest&, std_srvs::TriggerResponse& response) {
  const bool resumed = gate_.resume();
  response.success = static_cast<std::uint8_t>(resumed);
  response.message = resumed ? "going on" : "an emergency stop is still engaged";
  return true;
}

void SafetyInputs::onJoy(const sensor_msgs::Joy& joy) {
  const auto button = static_cast<std::size_t>(settings_.dead_man.button);
  gate_.deadMan(button < joy.buttons.size() && joy.buttons[button] != 0, joy.header.stamp);
}

void SafetyInputs::onRange(const sensor_msgs::Range& range) {
  gate_.obstacle(ObstacleSensor::kRange, distanceOf(range), range.header.stamp);
}

void SafetyInputs::onScan(const sensor_msgs::LaserScan& scan) {
  const ScanView view{scan.ranges.data(),   scan.ranges.size(), scan.angle_min,
                      scan.angle_increment, scan.range_min,     scan.range_max};
  gate_.obstacle(
      ObstacleSensor::kScan,
      nearestInCorridor(view, {settings_.obstacles.half_width_m, settings_.obstacles.slow_distance_m}),
      scan.header.stamp);
}

}  // namespace perennial
