#include "perennial/core/motion_interlock.h"

#include <algorithm>
#include <cmath>

#include "perennial/core/error.h"
#include "perennial/core/human_text.h"

namespace perennial {
namespace {

constexpr std::array<const char*, 3> kSensorNames{"range finder", "laser scanner", "obstacle detector"};

bool fresh(const std::optional<double>& stamp_s, double now_s, double timeout_s) {
  return stamp_s && now_s >= *stamp_s && now_s - *stamp_s <= timeout_s;
}

/// From when on a message's time-out runs; none when its stamp cannot be believed.
std::optional<double> saidAt(double stamp_s, double now_s, double timeout_s) {
  if (stamp_s == 0.0) {
    return now_s;
  }
  return stamp_s - now_s <= timeout_s ? std::optional<double>(std::min(stamp_s, now_s)) : std::nullopt;
}

/// What a single reading says: a distance, infinity for nothing within reach, NaN for nothing known.
double rangeOf(float reading, const ScanView& scan) {
  const auto range_m = static_cast<double>(reading);
  if (!(scan.range_max > std::max(scan.range_min, 0.0)) || std::isnan(range_m)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (range_m > scan.range_max) {
    return std::numeric_limits<double>::infinity();
  }
  if (std::isinf(range_m)) {
    return std::max(scan.range_min, 0.0);
  }
  return range_m > 0.0 ? range_m : std::numeric_limits<double>::quiet_NaN();
}

double finiteOrZero(double value) { return std::isfinite(value) ? value : 0.0; }

MotionPermit stop(std::string reason) { return {MotionPermit::Kind::kStop, 0.0, std::move(reason), {}}; }

}  // namespace

DeadManSettings DeadManSettings::load(ParameterReader& reader) {
  DeadManSettings settings;
  const std::string kind = reader.choice("kind", "none", {"none", "joy", "heartbeat"});
  settings.kind = kind == "joy" ? Kind::kJoy : kind == "heartbeat" ? Kind::kHeartbeat : Kind::kNone;
  settings.button = reader.integer("button", settings.button, 0, 100);
  settings.timeout_s = reader.real("timeout_s", settings.timeout_s, 0.05, 60.0);
  return settings;
}

ObstacleSettings ObstacleSettings::load(ParameterReader& reader) {
  ObstacleSettings settings;
  settings.range = reader.boolean("range", settings.range);
  settings.scan = reader.boolean("scan", settings.scan);
  settings.flag = reader.boolean("flag", settings.flag);
  settings.slow_distance_m = reader.real("slow_distance_m", settings.slow_distance_m, 0.0, 100.0);
  settings.stop_distance_m = reader.real("stop_distance_m", settings.stop_distance_m, 0.0, 100.0);
  settings.least_speed = reader.real("least_speed", settings.least_speed, 0.01, 1.0);
  settings.half_width_m = reader.real("half_width_m", settings.half_width_m, 0.01, 10.0);
  settings.timeout_s = reader.real("timeout_s", settings.timeout_s, 0.05, 60.0);
  if (settings.slow_distance_m < settings.stop_distance_m) {
    throw ParameterError(
        "parameter obstacles/slow_distance_m must not be less than obstacles/stop_distance_m");
  }
  return settings;
}

OverrideSettings OverrideSettings::load(ParameterReader& reader) {
  OverrideSettings settings;
  settings.timeout_s = reader.real("timeout_s", settings.timeout_s, 0.05, 60.0);
  settings.release_s = reader.real("release_s", settings.release_s, 0.05, 60.0);
  if (settings.release_s < settings.timeout_s) {
    throw ParameterError("parameter teleop/release_s must not be less than teleop/timeout_s");
  }
  return settings;
}

void MotionInterlock::setEmergencyStop(EmergencyStop source, bool engaged) {
  emergency_engaged_[static_cast<std::size_t>(source)] = engaged;
  emergency_latched_ = emergency_latched_ || engaged;
}

bool MotionInterlock::resume() {
  emergency_latched_ = emergency_engaged_[0] || emergency_engaged_[1];
  return !emergency_latched_;
}

void MotionInterlock::deadMan(bool held, double stamp_s, double now_s) {
  dead_man_held_ = held;
  dead_man_stamp_s_ = saidAt(stamp_s, now_s, settings_.dead_man.timeout_s);
}

void MotionInterlock::obstacle(ObstacleSensor sensor, double distance_m, double stamp_s, double now_s) {
  readings_[static_cast<std::size_t>(sensor)] = {distance_m,
                                                 saidAt(stamp_s, now_s, settings_.obstacles.timeout_s)};
}

void MotionInterlock::teleop(const Velocity& velocity, double now_s) {
  manual_ = {finiteOrZero(velocity.forward), finiteOrZero(velocity.angular), finiteOrZero(velocity.flipper)};
  manual_stamp_s_ = now_s;
}

void MotionInterlock::strangerCommanded(const std::string& name, double now_s) {
  stranger_ = name;
  stranger_stamp_s_ = now_s;
}

void MotionInterlock::forgetCommands() {
  manual_stamp_s_.reset();
  stranger_stamp_s_.reset();
}

std::string MotionInterlock::emergency() const {
  if (emergency_engaged_[0] || emergency_engaged_[1]) {
    return "the emergency stop is engaged";
  }
  return emergency_latched_ ? "there was an emergency stop; waiting for the service resume" : "";
}

std::string MotionInterlock::deadManProblem(double now_s) const {
  if (settings_.dead_man.kind == DeadManSettings::Kind::kNone) {
    return "";
  }
  if (!fresh(dead_man_stamp_s_, now_s, settings_.dead_man.timeout_s)) {
    return "no sign of life from the person who watches, or too late a one";
  }
  return dead_man_held_ ? "" : "the dead man's button is not held";
}

bool MotionInterlock::wanted(std::size_t sensor) const {
  const ObstacleSettings& obstacles = settings_.obstacles;
  return std::array<bool, 3>{obstacles.range, obstacles.scan, obstacles.flag}[sensor];
}

std::string MotionInterlock::sensorProblem(double now_s) const {
  for (std::size_t i = 0; i < readings_.size(); ++i) {
    if (!wanted(i)) {
      continue;
    }
    if (!fresh(readings_[i].stamp_s, now_s, settings_.obstacles.timeout_s)) {
      return std::string("the ") + kSensorNames[i] + " is silent, or its messages are late";
    }
    if (std::isnan(readings_[i].distance_m)) {
      return std::string("the ") + kSensorNames[i] + " does not know what is ahead";
    }
  }
  return "";
}

MotionPermit MotionInterlock::byObstacles() const {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < readings_.size(); ++i) {
    nearest_m = wanted(i) ? std::min(nearest_m, readings_[i].distance_m) : nearest_m;
  }
  const ObstacleSettings& obstacles = settings_.obstacles;
  if (nearest_m >= obstacles.slow_distance_m) {
    return {};
  }
  const std::string reason = "something is in the way, " + humanMetres(nearest_m) + " ahead";
  if (nearest_m <= obstacles.stop_distance_m) {
    return {MotionPermit::Kind::kHold, 0.0, reason, {}};
  }
  const double span_m = obstacles.slow_distance_m - obstacles.stop_distance_m;
  const double share = (nearest_m - obstacles.stop_distance_m) / span_m;
  return {MotionPermit::Kind::kGo, obstacles.least_speed + (1.0 - obstacles.least_speed) * share, reason, {}};
}

MotionPermit MotionInterlock::at(double now_s) const {
  if (const std::string problem = emergency(); !problem.empty()) {
    return stop(problem);
  }
  if (fresh(manual_stamp_s_, now_s, settings_.teleop.timeout_s)) {
    return {MotionPermit::Kind::kManual, 0.0, "driven by hand", manual_};
  }
  if (fresh(manual_stamp_s_, now_s, settings_.teleop.release_s)) {
    return stop("was driven by hand until a moment ago");
  }
  if (!master_alive_) {
    return stop("the ROS master does not answer");
  }
  if (fresh(stranger_stamp_s_, now_s, settings_.teleop.release_s)) {
    return stop(stranger_ + " commands the robot, too");
  }
  if (const std::string problem = deadManProblem(now_s); !problem.empty()) {
    return stop(problem);
  }
  if (const std::string problem = sensorProblem(now_s); !problem.empty()) {
    return stop(problem);
  }
  return byObstacles();
}

double nearestInCorridor(const ScanView& scan, const Corridor& corridor) {
  double nearest_m = std::numeric_limits<double>::infinity();
  bool looked = false;
  for (std::size_t i = 0; i < scan.count; ++i) {
    const double range_m = rangeOf(scan.ranges[i], scan);
    const double angle = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    if (std::isnan(range_m) || !(std::cos(angle) > 0.0)) {
      continue;
    }
    const double sideways = std::abs(std::sin(angle));
    looked = looked || sideways * corridor.depth_m <= corridor.half_width_m;
    if (std::isfinite(range_m) && sideways * range_m <= corridor.half_width_m) {
      nearest_m = std::min(nearest_m, range_m * std::cos(angle));
    }
  }
  return looked ? nearest_m : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace perennial
