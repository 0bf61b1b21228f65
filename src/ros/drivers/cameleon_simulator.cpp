#include "perennial/ros/drivers/cameleon_simulator.h"

#include <geometry_msgs/Twist.h>
#include <tf2/LinearMath/Quaternion.h>
#include <tf2/utils.h>
#include <tf2_geometry_msgs/tf2_geometry_msgs.h>

#include <cmath>

namespace perennial {
namespace {

geometry_msgs::Twist toTwist(const Velocity& velocity) {
  geometry_msgs::Twist twist;
  twist.linear.x = velocity.forward;
  twist.angular.z = velocity.angular;
  twist.angular.y = velocity.flipper;
  return twist;
}

/// A body that is further away in its next odometry did not drive there: tracks do not turn when it is
/// carried.
constexpr double kLongestBodyStep_m = 0.2;

double wrapAngle(double angle) { return std::remainder(angle, 2.0 * M_PI); }

}  // namespace

CameleonSimulatorSettings CameleonSimulatorSettings::load(ParameterReader& reader) {
  CameleonSimulatorSettings settings;
  settings.port = reader.integer("port", settings.port, 0, 65535);
  settings.bind_address = reader.text("bind_address", settings.bind_address);
  settings.track_distance_m = reader.real("track_distance_m", settings.track_distance_m, 0.05, 5.0);
  CameleonScale& scale = settings.scale;
  scale.forward_per_mps = reader.real("forward_per_mps", scale.forward_per_mps, 1.0, 1e5);
  scale.turn_per_radps = reader.real("turn_per_radps", scale.turn_per_radps, 1.0, 1e5);
  scale.flipper_per_radps = reader.real("flipper_per_radps", scale.flipper_per_radps, 1.0, 1e5);
  settings.battery_percent = reader.integer("battery_percent", settings.battery_percent, 0, 100);
  settings.external_body = reader.boolean("external_body", settings.external_body);
  settings.publish_clock = reader.boolean("publish_clock", settings.publish_clock);
  settings.clock_rate = reader.real("clock_rate", settings.clock_rate, 0.1, 20.0);
  return settings;
}

CameleonSimulator::CameleonSimulator(ros::NodeHandle nh, ros::NodeHandle private_nh,
                                     const CameleonSimulatorSettings& settings)
    : settings_(settings),
      server_(settings.bind_address, settings.port),
      robot_(settings.scale, settings.track_distance_m),
      state_publisher_(private_nh.advertise<nav_msgs::Odometry>("state", 200)) {
  robot_.setBattery(settings_.battery_percent);
  if (settings_.external_body) {
    body_command_publisher_ = nh.advertise<geometry_msgs::Twist>("body_cmd_vel", 10);
    body_subscriber_ = nh.subscribe("body_odom", 50, &CameleonSimulator::onBodyOdometry, this,
                                    ros::TransportHints().tcpNoDelay());
  }
  defineFaults();
  fault_service_ = private_nh.advertiseService("inject_fault", &CameleonSimulator::injectFault, this);
  if (settings_.publish_clock) {
    clock_ = std::make_unique<ClockPublisher>(nh, settings_.clock_rate, CameleonRobot::kLoopPeriod_s,
                                              [this] { loop(); });
  } else {
    timer_ = std::make_unique<TickTimer>(nh, CameleonRobot::kLoopPeriod_s, [this] { loop(); });
  }
  ROS_INFO("A simulated CAMELEON listens on %s, port %d.", settings_.bind_address.c_str(), server_.port());
}

void CameleonSimulator::defineFaults() {
  const auto frames = [](double value) { return static_cast<int>(value); };
  fault_setters_ = {
      {"stray_bytes", [=](double value, double) { faults_.stray_bytes = frames(value); }},
      {"half_frame", [=](double value, double) { faults_.half_frame_bytes = frames(value); }},
      {"wrong_type", [=](double value, double) { faults_.wrong_types = frames(value); }},
      {"wrong_validity", [=](double value, double) { faults_.wrong_validities = frames(value); }},
      {"silence", [=](double value, double now) { faults_.silent_until_s = now + value; }},
      {"freeze", [=](double value, double now) { faults_.frozen_until_s = now + value; }},
      {"close",
       [=](double value, double now) {
         faults_.refused_until_s = now + value;
         server_.closeClient();
       }},
      {"restart",
       [=](double value, double now) {
         faults_.refused_until_s = now + value;
         server_.closeClient();
         robot_.restartOdometers();
       }},
      {"jump",
       [=](double value, double) {
         robot_.jumpOdometers(static_cast<std::int32_t>(value), static_cast<std::int32_t>(value) / 2);
       }},
      {"latency", [=](double value, double) { faults_.latency_s = value; }},
      {"pitch", [=](double value, double) { robot_.setAttitude(frames(value), robot_.status().roll_deg); }},
      {"roll", [=](double value, double) { robot_.setAttitude(robot_.status().pitch_deg, frames(value)); }},
      {"battery", [=](double value, double) { robot_.setBattery(static_cast<int>(value)); }},
  };
}

bool CameleonSimulator::injectFault(perennial_nav::InjectFault::Request& request,
                                    perennial_nav::InjectFault::Response& response) {
  const auto setter = fault_setters_.find(request.fault);
  if (setter == fault_setters_.end() || !(std::abs(request.value) < 1e9)) {
    response.message = "the faults, each with a value, are:";
    for (const auto& [name, unused] : fault_setters_) {
      response.message += " " + name;
    }
    return true;
  }
  setter->second(request.value, loop_time_s_);
  response.success = true;
  return true;
}

void CameleonSimulator::loop() {
  loop_time_s_ += CameleonRobot::kLoopPeriod_s;
  server_.refuseClients(loop_time_s_ < faults_.refused_until_s);
  if (loop_time_s_ >= faults_.frozen_until_s) {
    receive(loop_time_s_);
    robot_.loop();
  }
  moveBody(robot_.velocity());
  if (loop_time_s_ >= faults_.frozen_until_s) {
    sendStatus(loop_time_s_);
  }
  publishState();
}

void CameleonSimulator::receive(double now_s) {
  const CameleonServer::Received received = server_.poll();
  if (received.handshake) {
    robot_.connect(*received.handshake);
    commands_.clear();
    statuses_.clear();
  }
  if (received.bad_commands > 0) {
    ROS_ERROR("%zu commands were none.", static_cast<std::size_t>(received.bad_commands));
  }
  for (const CameleonCommand& command : received.commands) {
    commands_.emplace_back(now_s + faults_.latency_s, command);
  }
  for (; !commands_.empty() && commands_.front().first <= now_s; commands_.pop_front()) {
    robot_.receive(commands_.front().second);
  }
}

void CameleonSimulator::moveBody(const Velocity& velocity) {
  if (settings_.external_body) {
    body_command_publisher_.publish(toTwist(velocity));
    return;
  }
  const double way = velocity.forward * CameleonRobot::kLoopPeriod_s;
  const double turn = velocity.angular * CameleonRobot::kLoopPeriod_s;
  const double chord = std::abs(turn) < 1e-9 ? way : way * std::sin(0.5 * turn) / (0.5 * turn);
  x_m_ += chord * std::cos(yaw_rad_ + 0.5 * turn);
  y_m_ += chord * std::sin(yaw_rad_ + 0.5 * turn);
  yaw_rad_ += turn;
  robot_.moved(way, turn);
}

void CameleonSimulator::onBodyOdometry(const nav_msgs::Odometry& odometry) {
  const BodyPose pose{odometry.pose.pose.position.x, odometry.pose.pose.position.y,
                      tf2::getYaw(odometry.pose.pose.orientation)};
  const bool was_put_elsewhere =
      body_ && std::hypot(pose.x_m - body_->x_m, pose.y_m - body_->y_m) > kLongestBodyStep_m;
  if (body_ && !was_put_elsewhere) {
    const double turn = wrapAngle(pose.yaw_rad - body_->yaw_rad);
    const double heading = body_->yaw_rad + 0.5 * turn;
    const double chord =
        (pose.x_m - body_->x_m) * std::cos(heading) + (pose.y_m - body_->y_m) * std::sin(heading);
    const double way = std::abs(turn) < 1e-9 ? chord : chord * (0.5 * turn) / std::sin(0.5 * turn);
    robot_.moved(way, turn);
  }
  body_ = pose;
  x_m_ = pose.x_m;
  y_m_ = pose.y_m;
  yaw_rad_ = pose.yaw_rad;
}

void CameleonSimulator::sendStatus(double now_s) {
  if (now_s >= faults_.silent_until_s) {
    statuses_.emplace_back(now_s + faults_.latency_s, faults_.distort(robot_.status(), random_));
  }
  for (; !statuses_.empty() && statuses_.front().first <= now_s; statuses_.pop_front()) {
    server_.send(statuses_.front().second);
  }
}

void CameleonSimulator::publishState() {
  nav_msgs::Odometry state;
  state.header.stamp.fromSec(loop_time_s_);
  state.header.frame_id = "world";
  state.pose.pose.position.x = x_m_;
  state.pose.pose.position.y = y_m_;
  tf2::Quaternion orientation;
  orientation.setRPY(0.0, 0.0, yaw_rad_);
  state.pose.pose.orientation = tf2::toMsg(orientation);
  state.twist.twist = toTwist(robot_.velocity());
  state_publisher_.publish(state);
}

}  // namespace perennial
