#include "perennial/park/park_simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "perennial/core/error.h"

namespace perennial::park {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1000000000;

std::int64_t toNs(double seconds) { return std::llround(seconds * 1e6) * 1000; }

/// Tilt of the robot on uneven ground: smooth noise of the place, so that it is the same on every traversal.
double bump(double x, double y, int channel) {
  constexpr double kCellM = 0.35;
  const auto corner = [&](double i, double j) {
    return Random(mix({static_cast<std::int64_t>(i), static_cast<std::int64_t>(j), channel, 88})).normal();
  };
  const double i = std::floor(x / kCellM), j = std::floor(y / kCellM);
  const double u = x / kCellM - i, v = y / kCellM - j;
  const double su = u * u * (3.0 - 2.0 * u), sv = v * v * (3.0 - 2.0 * v);
  return (corner(i, j) * (1.0 - su) + corner(i + 1, j) * su) * (1.0 - sv) +
         (corner(i, j + 1) * (1.0 - su) + corner(i + 1, j + 1) * su) * sv;
}

}  // namespace

ParkSettings ParkSettings::load(ParameterReader& reader) {
  ParkSettings s;
  s.loop.length_m = reader.real("loop_length_m", s.loop.length_m, 30.0, 36.0);
  s.loop.shape_seed = reader.integer("loop_shape_seed", s.loop.shape_seed, 0, 1000000);
  s.robot = RobotSettings::load(reader);
  s.driver = DriverSettings::load(reader);
  s.camera = CameraSettings::load(reader);
  s.image_rate_hz = reader.integer("image_rate_hz", s.image_rate_hz, 1, 60);
  s.odometry_rate_hz = reader.integer("odometry_rate_hz", s.odometry_rate_hz, 10, 1000);
  s.colour = reader.boolean("colour", s.colour);
  s.noise_seed = reader.integer("noise_seed", s.noise_seed, 0, 1000000);
  if (s.odometry_rate_hz % s.image_rate_hz != 0) {
    throw ParameterError("parameter odometry_rate_hz is " + std::to_string(s.odometry_rate_hz) +
                         ", but must be a multiple of image_rate_hz, which is " +
                         std::to_string(s.image_rate_hz));
  }
  return s;
}

ParkSimulation::ParkSimulation(const ParkSettings& settings, const Conditions& conditions)
    : settings_(settings),
      conditions_(conditions),
      path_(settings.loop),
      renderer_(path_, settings.camera.geometry),
      camera_(settings.camera, static_cast<std::uint64_t>(settings.noise_seed)),
      robot_(settings.robot, static_cast<std::uint64_t>(settings.noise_seed)),
      driver_(path_, settings.driver) {
  restartClock(toNs(conditions.date_time_s));
  place(0.0, 0.0);
}

void ParkSimulation::place(double lateral_m, double heading_rad) {
  const Pose start = path_.at(0.0);
  robot_.place({start.x - lateral_m * std::sin(start.heading), start.y + lateral_m * std::cos(start.heading),
                wrapAngle(start.heading + heading_rad)},
               now_ns_);
  exposure_settled_ = false;
}

void ParkSimulation::setConditions(const Conditions& conditions) {
  conditions_ = conditions;
  const std::int64_t wanted_ns = toNs(conditions.date_time_s);
  if (wanted_ns > now_ns_) {
    world_offset_s_ = 0.0;
    restartClock(wanted_ns);
    robot_.standUntil(wanted_ns);
  } else {
    world_offset_s_ = conditions.date_time_s - static_cast<double>(now_ns_) * 1e-9;
  }
  exposure_settled_ = false;
}

void ParkSimulation::command(const Velocity& velocity) { robot_.command(velocity, now_ns_); }

void ParkSimulation::setDriver(bool drives) {
  drives_ = drives;
  driver_.start();
}

Velocity ParkSimulation::driverCommand() {
  return driver_.drive(robot_.truePose(), static_cast<double>(now_ns_) * 1e-9);
}

ParkFrame ParkSimulation::step() {
  std::vector<Odometry> odometry;
  for (int i = 0; i < ticksPerImage(); ++i) {
    odometry.push_back(tick());
  }
  ParkFrame frame = look();
  frame.odometry = std::move(odometry);
  return frame;
}

Odometry ParkSimulation::tick() {
  now_ns_ = tickNs(++tick_);
  robot_.advance(now_ns_);
  return robot_.odometry();
}

ParkFrame ParkSimulation::look() {
  ParkFrame frame;
  if (!exposure_settled_) {
    settleExposure();
  }
  frame.stamp_ns = now_ns_;
  frame.image = shoot();
  frame.true_pose = robot_.truePose();
  frame.true_velocity = robot_.velocity();
  const LoopPath::Nearest nearest = path_.nearest(frame.true_pose.x, frame.true_pose.y);
  frame.arc_length_m = nearest.arc_length_m;
  frame.lateral_m = nearest.lateral_m;
  return frame;
}

double ParkSimulation::worldTime() const { return static_cast<double>(now_ns_) * 1e-9 + world_offset_s_; }

Conditions ParkSimulation::conditions() const {
  Conditions now = conditions_;
  now.date_time_s = worldTime();
  return now;
}

std::int64_t ParkSimulation::tickNs(std::int64_t tick) const {
  return start_ns_ + tick * kNanosecondsPerSecond / settings_.odometry_rate_hz;
}

CameraPose ParkSimulation::cameraPose() const {
  const Pose robot = robot_.truePose();
  const double jolt = settings_.camera.jolt_deg * 3.14159265358979323846 / 180.0;
  CameraPose pose;
  pose.x = robot.x + settings_.camera.forward_m * std::cos(robot.heading);
  pose.y = robot.y + settings_.camera.forward_m * std::sin(robot.heading);
  pose.z = settings_.camera.height_m;
  pose.heading = robot.heading;
  pose.pitch = jolt * bump(robot.x, robot.y, 1);
  pose.roll = jolt * bump(robot.x, robot.y, 2);
  return pose;
}

cv::Mat ParkSimulation::shoot() {
  const Conditions now = conditions();
  const CameraPose pose = cameraPose();
  const double exposure = camera_.exposure();
  cv::Mat rendered = renderer_.render(now, pose, exposure).clone();
  drawPrecipitation(rendered, now, pose, settings_.camera.geometry, camera_.state().time_ms * 1e-3, exposure);
  return camera_.develop(rendered, robot_.velocity().angular, now_ns_, settings_.colour);
}

/// A camera that was switched on a while ago has found its exposure already.
void ParkSimulation::settleExposure() {
  constexpr int kMostImages = 25;
  for (int i = 0; i < kMostImages; ++i) {
    shoot();
    if (camera_.state().settled) {
      break;
    }
  }
  exposure_settled_ = true;
}

void ParkSimulation::restartClock(std::int64_t now_ns) {
  start_ns_ = now_ns_ = now_ns;
  tick_ = 0;
}

}  // namespace perennial::park
