#include "perennial/ros/drivers/cameleon_driver.h"

#include <geometry_msgs/TransformStamped.h>

#include <chrono>

namespace perennial {
namespace {

/// The robot's watchdog stops it about so long after the last command, which bounds how far it rolls unseen.
constexpr double kRobotWatchdog_s = 0.84;
/// Below this a robot that is supposed to send 25 statuses a second is in trouble, 1/s.
constexpr double kLowStatusRate = 15.0;
constexpr double kLongestTick_s = 0.5;

geometry_msgs::TransformStamped toTransform(const nav_msgs::Odometry& odometry) {
  geometry_msgs::TransformStamped transform;
  transform.header = odometry.header;
  transform.child_frame_id = odometry.child_frame_id;
  transform.transform.translation.x = odometry.pose.pose.position.x;
  transform.transform.translation.y = odometry.pose.pose.position.y;
  transform.transform.rotation = odometry.pose.pose.orientation;
  return transform;
}

}  // namespace

CameleonDriver::CameleonDriver(ros::NodeHandle nh, ros::NodeHandle private_nh,
                               const CameleonDriverSettings& settings)
    : settings_(settings),
      odometry_publisher_(nh.advertise<nav_msgs::Odometry>("odom", 50)),
      battery_publisher_(nh.advertise<sensor_msgs::BatteryState>("battery", 5)),
      joint_publisher_(nh.advertise<sensor_msgs::JointState>("joint_states", 5)),
      gate_(settings.limits, settings.command_timeout_s, settings.command_settle_s),
      odometry_(settings.odometry),
      rate_since_s_(driverTime()),
      diagnostics_(nh, private_nh),
      master_(std::chrono::milliseconds(static_cast<int>(settings.master_timeout_s * 1000.0))) {
  diagnostics_.setHardwareID("CAMELEON " + settings_.link.host);
  diagnostics_.add("connection", this, &CameleonDriver::diagnoseConnection);
  diagnostics_.add("robot", this, &CameleonDriver::diagnoseRobot);
  link_ = std::make_unique<CameleonLink>(
      settings_.link, CameleonHandshake(),
      CameleonLink::Callbacks{[this](const CameleonStatus& status) { onStatus(status); },
                              [this](bool connected) { onConnection(connected); }});
  command_subscriber_ =
      nh.subscribe("cmd_vel", 1, &CameleonDriver::onCommand, this, ros::TransportHints().tcpNoDelay());
  emergency_stop_subscriber_ = nh.subscribe("emergency_stop", 10, &CameleonDriver::onEmergencyStop, this);
  timer_ = std::make_unique<TickTimer>(nh, 1.0 / settings_.command_rate_hz, [this] { tick(); });
}

CameleonDriver::~CameleonDriver() {
  timer_.reset();
  command_subscriber_.shutdown();
  emergency_stop_subscriber_.shutdown();
  link_->sendLast({CameleonCommandType::kSpeed, 0, 0, 0}, std::chrono::milliseconds(200));
  link_->sendLast({CameleonCommandType::kStop, 0, 0, 0}, std::chrono::milliseconds(200));
  link_.reset();
}

void CameleonDriver::onCommand(const geometry_msgs::Twist& twist) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const Velocity wanted{twist.linear.x, twist.angular.z, twist.angular.y};
  if (!gate_.command(wanted, driverTime())) {
    ++refused_commands_;
    const std::string reason = gate_.holdReason();
    ROS_WARN_THROTTLE(5.0, "A command was ignored: %s.",
                      reason.empty() ? "it is not a number" : reason.c_str());
  }
}

void CameleonDriver::onEmergencyStop(const std_msgs::Bool& engaged) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    gate_.setEmergencyStop(engaged.data);
  }
  ROS_WARN("Emergency stop %s.", engaged.data ? "engaged" : "cleared");
  if (engaged.data) {
    link_->send({CameleonCommandType::kSpeed, 0, 0, 0});  // at once, not at the next tick
  }
}

void CameleonDriver::onStatus(const CameleonStatus& status) {
  const ros::Time stamp = ros::Time::now();
  OdometryState odometry;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    last_status_ = status;
    last_status_s_ = driverTime();
    if (!status.valid) {
      ++invalid_statuses_;
      return;
    }
    const std::uint64_t jumps = odometry_.jumps();
    odometry_.update(status.left_mm, status.right_mm, last_status_s_);
    if (odometry_.jumps() != jumps) {
      ROS_WARN("The robot's odometers jumped; odometry goes on from where it was.");
    }
    odometry = odometry_.state();
  }
  publish(status, odometry, stamp);
}

void CameleonDriver::onConnection(bool connected) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    connected_ = connected;
    gate_.setConnected(connected);
    odometry_.restart(settings_.limits.max_forward_mps * kRobotWatchdog_s);
    last_status_s_ = driverTime();
  }
  ROS_INFO("%s the robot at %s.", connected ? "Connected to" : "Lost", settings_.link.host.c_str());
}

void CameleonDriver::tick() {
  const double now = driverTime();
  const bool alive = master_.alive();
  Velocity velocity;
  bool silent = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (now - last_tick_s_ > kLongestTick_s) {
      last_status_s_ = now;  // it was this clock or this node that paused, not the robot
    }
    last_tick_s_ = now;
    gate_.setSystemAlive(alive);
    velocity = gate_.next(now);
    silent = connected_ && now - last_status_s_ > settings_.status_timeout_s;
  }
  if (silent) {
    link_->restart("the robot was silent for too long");
  } else {
    link_->send(toSpeedCommand(velocity, settings_.scale));
  }
  diagnostics_.update();
}

void CameleonDriver::publish(const CameleonStatus& status, const OdometryState& odometry,
                             const ros::Time& stamp) {
  const nav_msgs::Odometry message = toOdometry(odometry, status, settings_.frames, stamp);
  odometry_publisher_.publish(message);
  battery_publisher_.publish(toBatteryState(status, stamp));
  joint_publisher_.publish(toJointState(status, settings_.frames, stamp));
  if (settings_.publish_tf) {
    transform_broadcaster_.sendTransform(toTransform(message));
  }
}

void CameleonDriver::diagnoseConnection(diagnostic_updater::DiagnosticStatusWrapper& report) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  const CameleonLink::Counters counters = link_->counters();
  const std::lock_guard<std::mutex> lock(mutex_);
  const double now = driverTime();
  const double elapsed = now - rate_since_s_;
  const double rate =
      elapsed > 0.0 ? static_cast<double>(counters.parser.frames - rate_frames_) / elapsed : 0.0;
  rate_since_s_ = now;
  rate_frames_ = counters.parser.frames;
  if (!connected_) {
    report.summary(Status::ERROR, "not connected: " + counters.last_error);
  } else if (rate < kLowStatusRate) {
    report.summary(Status::WARN, "few statuses");
  } else {
    report.summary(Status::OK, "connected");
  }
  report.add("status rate (1/s)", rate);
  report.add("statuses", counters.parser.frames);
  report.add("bad frames", counters.parser.bad_frames);
  report.add("stray bytes", counters.parser.stray_bytes);
  report.add("connections", counters.connections);
}

void CameleonDriver::diagnoseRobot(diagnostic_updater::DiagnosticStatusWrapper& report) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string reason = gate_.holdReason();
  report.summary(Status::OK, "ready");
  if (!reason.empty()) {
    report.mergeSummary(Status::WARN, "held: " + reason);
  }
  if (last_status_ && !last_status_->valid) {
    report.mergeSummary(Status::WARN, "the robot calls its values invalid");
  }
  if (last_status_ && last_status_->battery_percent < settings_.battery_low_percent) {
    report.mergeSummary(Status::WARN, "battery low");
  }
  report.add("battery (%)", last_status_ ? last_status_->battery_percent : -1);
  report.add("statuses called invalid", invalid_statuses_);
  report.add("odometer jumps", odometry_.jumps());
  report.add("ignored commands", refused_commands_);
}

}  // namespace perennial
