#include "perennial/ros/park_simulator.h"

#include <cv_bridge/cv_bridge.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <ros/callback_queue.h>
#include <rosgraph_msgs/Clock.h>
#include <tf2/LinearMath/Quaternion.h>
#include <tf2_geometry_msgs/tf2_geometry_msgs.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/park/conditions_yaml.h"
#include "perennial/ros/conversions.h"
#include "perennial/ros/parameters.h"

namespace perennial {
namespace {

constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;
constexpr char kParkFrame[] = "park";

ros::Time timeOf(std::int64_t stamp_ns) { return ros::Time().fromNSec(static_cast<std::uint64_t>(stamp_ns)); }

geometry_msgs::Quaternion headingToMessage(double heading) {
  tf2::Quaternion quaternion;
  quaternion.setRPY(0.0, 0.0, heading);
  return tf2::toMsg(quaternion);
}

nav_msgs::Odometry odometryMessage(const ros::Time& stamp, const std::string& frame,
                                   const std::string& child_frame, const park::Pose& pose, double forward,
                                   double angular) {
  nav_msgs::Odometry message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.child_frame_id = child_frame;
  message.pose.pose.position.x = pose.x;
  message.pose.pose.position.y = pose.y;
  message.pose.pose.orientation = headingToMessage(pose.heading);
  message.twist.twist.linear.x = forward;
  message.twist.twist.angular.z = angular;
  return message;
}

/// Variances of x, y, heading (or forward, sideways, turn); the rest of the six does not move.
template <typename Covariance>
void setCovariance(Covariance& covariance, double x, double y, double heading) {
  constexpr double kFixed = 1e-6;
  covariance.fill(0.0);
  covariance[0] = x;
  covariance[7] = y;
  covariance[14] = covariance[21] = covariance[28] = kFixed;
  covariance[35] = heading;
}

sensor_msgs::CameraInfo cameraInfo(const park::CameraGeometry& g) {
  sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(g.width);
  info.height = static_cast<std::uint32_t>(g.height);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {g.fx, 0.0, g.cx, 0.0, g.fy, g.cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {g.fx, 0.0, g.cx, 0.0, 0.0, g.fy, g.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

std::vector<std::string> wordsOf(std::string text) {
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : ", ") + word;
  }
  return text;
}

park::Conditions loadConditions(const ros::NodeHandle& private_nh) {
  ParameterReader reader = groupReader(private_nh, "conditions");
  const park::Conditions conditions = park::Conditions::load(reader, {});
  reader.requireAllUsed();
  return conditions;
}

}  // namespace

ParkSimulatorSettings ParkSimulatorSettings::load(ParameterReader& reader) {
  ParkSimulatorSettings s;
  s.lockstep = wordsOf(reader.text("lockstep", ""));
  s.lockstep_timeout_s = reader.real("lockstep_timeout_s", s.lockstep_timeout_s, 0.1, 600.0);
  s.real_time_factor = reader.real("real_time_factor", s.real_time_factor, 0.01, 1000.0);
  s.odom_frame = reader.text("odom_frame", s.odom_frame);
  s.base_frame = reader.text("base_frame", s.base_frame);
  s.camera_frame = reader.text("camera_frame", s.camera_frame);
  s.drive = reader.boolean("drive", s.drive);
  s.through_drivers = reader.boolean("through_drivers", s.through_drivers);
  return s;
}

ParkSimulator::ParkSimulator(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : nh_(std::move(nh)),
      private_nh_(std::move(private_nh)),
      settings_(loadNode<ParkSimulatorSettings>(private_nh_, {"park", "conditions"})),
      simulation_(loadGroup<park::ParkSettings>(private_nh_, "park"), loadConditions(private_nh_)),
      gate_(settings_.lockstep, settings_.through_drivers),
      transport_(nh_),
      camera_publisher_(transport_.advertiseCamera("image_raw", 10)),
      diagnostics_(nh_, private_nh_) {
  clock_publisher_ = nh_.advertise<rosgraph_msgs::Clock>("/clock", 100);
  odometry_publisher_ = nh_.advertise<nav_msgs::Odometry>("odom", 1000);
  truth_publisher_ = nh_.advertise<nav_msgs::Odometry>("ground_truth", 1000);
  loop_publisher_ = nh_.advertise<nav_msgs::Path>("loop_path", 1, true);
  command_publisher_ =
      nh_.advertise<geometry_msgs::Twist>(settings_.through_drivers ? "driver_cmd_vel" : "cmd_vel", 100);
  command_subscriber_ = nh_.subscribe("cmd_vel", 100, &ParkSimulator::onCommand, this);
  processed_subscriber_ = nh_.subscribe<perennial_nav::Processed>(
      "processed", 1000,
      [this](const perennial_nav::ProcessedConstPtr& message) { gate_.onProcessed(*message); });
  service_ = nh_.advertiseService("set_park", &ParkSimulator::onSetPark, this);
  diagnostics_.setHardwareID("none");
  diagnostics_.add("park", [this](auto& status) { diagnose(status); });
  simulation_.setDriver(settings_.drive);
  publishLoop();
  publishCameraMount();
}

void ParkSimulator::run(const std::function<bool()>& stop) {
  stop_ = stop;
  awaitNodes();
  next_image_ = ros::WallTime::now();
  while (ros::ok() && !stop_()) {
    step();
    diagnostics_.update();
  }
}

void ParkSimulator::step() {
  if (settings_.through_drivers) {
    runThroughDrivers();
  } else if (simulation_.driverDrives()) {
    drive();
  }
  const park::ParkFrame frame = settings_.through_drivers ? simulation_.look() : simulation_.step();
  for (const park::Odometry& odometry : frame.odometry) {
    publishTick(odometry);
  }
  publishTruth(frame);
  gate_.expect(timeOf(frame.stamp_ns));
  publishImage(frame);
  lateral_m_ = frame.lateral_m;
  if (settings_.lockstep.empty()) {
    keepPace();
  } else if (!settings_.through_drivers) {
    awaitAnswers();
  }
}

/// Time up to the next image, tick by tick, so that the clocks of the drivers tick in between. The last image
/// is answered on the way and not before: its odometry comes with the robot's next status. A node that has
/// not answered by then makes time run slowly, and stand still before the next image.
void ParkSimulator::runThroughDrivers() {
  constexpr double kTimeForMessagesS = 0.003;
  const ros::WallDuration kPatience(0.2);
  constexpr int kTicksUntilAnswer = 3;  // one loop of the robot, 40 ms
  const double tick_s = 1.0 / (simulation_.settings().odometry_rate_hz * settings_.real_time_factor);
  const ros::WallDuration pause(settings_.lockstep.empty() ? 0.5 * tick_s : kTimeForMessagesS);
  const auto never = [] { return false; };
  for (int i = 0; i < simulation_.ticksPerImage(); ++i) {
    if (simulation_.driverDrives()) {
      drive();
    }
    publishTick(simulation_.tick());
    serveUntil(never, ros::WallTime::now() + pause);
    if (i >= kTicksUntilAnswer && !settings_.lockstep.empty()) {
      serveUntil([this] { return gate_.open(); }, ros::WallTime::now() + kPatience);
    }
  }
  awaitAnswers();
}

/// Time stands still until those in lockstep are connected, so that none misses the first image. The clock is
/// published meanwhile, for nodes that wait for it when they start.
void ParkSimulator::awaitNodes() {
  constexpr double kClockIntervalS = 0.1;
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(settings_.lockstep_timeout_s);
  const auto connected = [this] {
    const std::size_t cameras = settings_.through_drivers ? 1 : settings_.lockstep.size();
    return settings_.lockstep.empty() ||
           (processed_subscriber_.getNumPublishers() >= settings_.lockstep.size() &&
            camera_publisher_.getNumSubscribers() >= cameras);
  };
  do {
    publishClock(simulation_.nowNs());
  } while (
      !serveUntil(connected, std::min(deadline, ros::WallTime::now() + ros::WallDuration(kClockIntervalS))) &&
      ros::ok() && !stop_() && ros::WallTime::now() < deadline);
}

void ParkSimulator::awaitAnswers() {
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(settings_.lockstep_timeout_s);
  if (!serveUntil([this] { return gate_.open(); }, deadline) && ros::ok() && !stop_()) {
    ++timeouts_;
    ROS_WARN_STREAM_THROTTLE(10.0, "lockstep: no answer within " << settings_.lockstep_timeout_s << " s from "
                                                                 << joined(gate_.missing())
                                                                 << "; time goes on");
    gate_.giveUp();
  }
}

void ParkSimulator::keepPace() {
  const double interval_s = 1.0 / (simulation_.settings().image_rate_hz * settings_.real_time_factor);
  next_image_ += ros::WallDuration(interval_s);
  const ros::WallTime now = ros::WallTime::now();
  next_image_ = std::max(next_image_, now);  // A machine that is too slow does not catch up later.
  serveUntil([] { return false; }, next_image_);
}

bool ParkSimulator::serveUntil(const std::function<bool()>& done, const ros::WallTime& deadline) {
  constexpr double kLongestWaitS = 0.05;
  ros::getGlobalCallbackQueue()->callAvailable();
  while (ros::ok() && !stop_() && !done()) {
    const double left_s = (deadline - ros::WallTime::now()).toSec();
    if (left_s <= 0.0) {
      return false;
    }
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(std::min(left_s, kLongestWaitS)));
  }
  return done();
}

void ParkSimulator::onCommand(const geometry_msgs::Twist& message) {
  gate_.onCommand(message);
  if (simulation_.driverDrives() && !settings_.through_drivers) {
    return;  // The driver's own commands come by here, too; the robot has them already.
  }
  try {
    simulation_.command(fromMessage(message));
  } catch (const Error& error) {
    ++refused_commands_;
    ROS_WARN_STREAM_THROTTLE(5.0, "cmd_vel refused: " << error.what());
  }
}

void ParkSimulator::drive() {
  const Velocity velocity = simulation_.driverCommand();
  if (!settings_.through_drivers) {
    simulation_.command(velocity);
  }
  command_publisher_.publish(toMessage(velocity));
  if (simulation_.driverFinished()) {
    ROS_INFO("the driver is round the loop");
    simulation_.setDriver(false);
  }
}

bool ParkSimulator::onSetPark(perennial_nav::SetPark::Request& request,
                              perennial_nav::SetPark::Response& response) {
  try {
    if (!std::isfinite(request.lateral_offset_m) || !std::isfinite(request.heading_offset_deg)) {
      throw ParameterError("lateral_offset_m and heading_offset_deg must be finite");
    }
    if (!request.conditions.empty()) {
      simulation_.setConditions(park::mergedConditions(simulation_.conditions(), request.conditions));
    }
    simulation_.place(request.lateral_offset_m, request.heading_offset_deg * kRadPerDeg);
    simulation_.setDriver(request.drive != 0);
    response.success = 1;
    response.message = "it is " + park::formatDateTime(simulation_.worldTime()) + " in the park";
  } catch (const Error& error) {
    response.success = 0;
    response.message = error.what();
  }
  return true;
}

void ParkSimulator::publishClock(std::int64_t stamp_ns) {
  rosgraph_msgs::Clock message;
  message.clock = timeOf(stamp_ns);
  clock_publisher_.publish(message);
}

void ParkSimulator::publishTick(const park::Odometry& odometry) {
  publishClock(odometry.stamp_ns);
  publishOdometry(odometry);
}

void ParkSimulator::publishOdometry(const park::Odometry& odometry) {
  const park::RobotSettings& robot = simulation_.settings().robot;
  nav_msgs::Odometry message =
      odometryMessage(timeOf(odometry.stamp_ns), settings_.odom_frame, settings_.base_frame, odometry.pose,
                      odometry.forward, odometry.angular);
  const double travelled_m = std::max(std::abs(odometry.distance_m), 0.01);
  const double distance_variance = robot.odometry_noise * robot.odometry_noise * travelled_m + 1e-6;
  const double heading_variance = robot.heading_noise * robot.heading_noise * travelled_m + 1e-6;
  setCovariance(message.pose.covariance, distance_variance, distance_variance, heading_variance);
  const double step_m = std::abs(odometry.forward) / simulation_.settings().odometry_rate_hz;
  const double rate2 = std::pow(simulation_.settings().odometry_rate_hz, 2);
  setCovariance(message.twist.covariance, robot.odometry_noise * robot.odometry_noise * step_m * rate2 + 1e-6,
                1e-6, robot.heading_noise * robot.heading_noise * step_m * rate2 + 1e-6);
  odometry_publisher_.publish(message);

  geometry_msgs::TransformStamped transform;
  transform.header = message.header;
  transform.child_frame_id = message.child_frame_id;
  transform.transform.translation.x = odometry.pose.x;
  transform.transform.translation.y = odometry.pose.y;
  transform.transform.rotation = message.pose.pose.orientation;
  transforms_.sendTransform(transform);
}

void ParkSimulator::publishTruth(const park::ParkFrame& frame) {
  nav_msgs::Odometry message =
      odometryMessage(timeOf(frame.stamp_ns), kParkFrame, settings_.base_frame, frame.true_pose,
                      frame.true_velocity.forward, frame.true_velocity.angular);
  setCovariance(message.pose.covariance, 0.0, 0.0, 0.0);
  setCovariance(message.twist.covariance, 0.0, 0.0, 0.0);
  truth_publisher_.publish(message);
}

void ParkSimulator::publishImage(const park::ParkFrame& frame) {
  std_msgs::Header header;
  header.stamp = timeOf(frame.stamp_ns);
  header.frame_id = settings_.camera_frame;
  const bool colour = frame.image.channels() == 3;
  sensor_msgs::CameraInfo info = cameraInfo(simulation_.settings().camera.geometry);
  info.header = header;
  camera_publisher_.publish(*cv_bridge::CvImage(header, colour ? "bgr8" : "mono8", frame.image).toImageMsg(),
                            info);
  ++images_;
  const ros::WallTime now = ros::WallTime::now();
  if (!last_image_.isZero() && now > last_image_) {
    const double rate = 1.0 / (now - last_image_).toSec();
    images_per_s_ = images_per_s_ == 0.0 ? rate : 0.9 * images_per_s_ + 0.1 * rate;
  }
  last_image_ = now;
}

void ParkSimulator::publishLoop() {
  constexpr double kStepM = 0.1;
  nav_msgs::Path path;
  path.header.frame_id = kParkFrame;
  path.header.stamp = timeOf(simulation_.nowNs());
  for (double s = 0.0; s <= simulation_.path().length(); s += kStepM) {
    const park::Pose pose = simulation_.path().at(s);
    geometry_msgs::PoseStamped point;
    point.header = path.header;
    point.pose.position.x = pose.x;
    point.pose.position.y = pose.y;
    point.pose.orientation = headingToMessage(pose.heading);
    path.poses.push_back(point);
  }
  loop_publisher_.publish(path);
}

/// The camera's frame is an optical one (REP 103): z forward, x right, y down.
void ParkSimulator::publishCameraMount() {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = timeOf(simulation_.nowNs());
  transform.header.frame_id = settings_.base_frame;
  transform.child_frame_id = settings_.camera_frame;
  transform.transform.translation.x = simulation_.settings().camera.forward_m;
  transform.transform.translation.z = simulation_.settings().camera.height_m;
  tf2::Quaternion rotation;
  rotation.setRPY(-90.0 * kRadPerDeg, 0.0, -90.0 * kRadPerDeg);
  transform.transform.rotation = tf2::toMsg(rotation);
  static_transforms_.sendTransform(transform);
}

void ParkSimulator::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  if (timeouts_ > 0 && !gate_.open()) {
    status.summary(diagnostic_msgs::DiagnosticStatus::WARN, "waiting for " + joined(gate_.missing()));
  } else {
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, "simulating");
  }
  status.add("time in the park", park::formatDateTime(simulation_.worldTime()));
  status.add("images", images_);
  status.add("images per second", images_per_s_);
  status.add("lockstep time-outs", timeouts_);
  status.add("refused commands", refused_commands_);
  status.add("distance from the path, left (m)", lateral_m_);
  status.add("exposure time (ms)", simulation_.exposure().time_ms);
  status.add("gain", simulation_.exposure().gain);
  status.add("driver", simulation_.driverDrives() ? "drives" : "rests");
}

}  // namespace perennial
