#include "perennial/core/navigation_supervisor.h"

#include <algorithm>
#include <cmath>

#include "perennial/core/human_text.h"

namespace perennial {
namespace {

/// Time that goes back by less is two clocks' disagreement, not a jump.
constexpr double kBackwards_s = 0.2;
/// Time that goes on by more between two looks was set, and is no silence of the sensors.
constexpr double kForwards_s = 5.0;

}  // namespace

SupervisorSettings SupervisorSettings::load(ParameterReader& reader) {
  SupervisorSettings settings;
  settings.max_blind_start_m = reader.real("max_blind_start_m", settings.max_blind_start_m, 0.0, 1e6);
  settings.max_blind_distance_m =
      reader.real("max_blind_distance_m", settings.max_blind_distance_m, 0.0, 1e6);
  settings.sights_to_trust = reader.integer("sights_to_trust", settings.sights_to_trust, 1, 1000);
  settings.hold_timeout_s = reader.real("hold_timeout_s", settings.hold_timeout_s, 0.1, 1e6);
  settings.blind_speed = reader.real("blind_speed", settings.blind_speed, 0.05, 1.0);
  settings.least_speed = reader.real("least_speed", settings.least_speed, 0.05, 1.0);
  settings.full_confidence = reader.real("full_confidence", settings.full_confidence, 0.0, 1.0);
  settings.camera = ImageWatchSettings::load(reader);
  return settings;
}

const char* nameOf(NavigationMode mode) {
  switch (mode) {
    case NavigationMode::kIdle:
      return "idle";
    case NavigationMode::kStarting:
      return "starting";
    case NavigationMode::kRepeating:
      return "repeating";
    case NavigationMode::kDegraded:
      return "degraded";
    case NavigationMode::kHolding:
      return "holding";
    case NavigationMode::kStopped:
      return "stopped";
    case NavigationMode::kFinished:
      return "finished";
    case NavigationMode::kFailed:
      return "failed";
  }
  return "failed";
}

NavigationSupervisor::NavigationSupervisor(const SupervisorSettings& settings) : settings_(settings) {}

bool NavigationSupervisor::active() const {
  return status_.mode != NavigationMode::kIdle && status_.mode != NavigationMode::kFinished &&
         status_.mode != NavigationMode::kFailed;
}

void NavigationSupervisor::start(double now_s) {
  newest_s_ = seen_s_ = now_s;
  seen_any_ = on_path_ = false;
  sight_ = {};
  sights_in_a_row_ = 0;
  blind_from_m_ = blind_m_ = 0.0;
  holding_since_s_.reset();
  late_ = false;
  image_problem_.clear();
  starting_ = "waiting for image, odometry and local maps";
  set(NavigationMode::kStarting, starting_, 0.0);
}

const NavigationStatus& NavigationSupervisor::see(double stamp_s, double travelled_m, const Sight& sight,
                                                  const MotionPermit& permit) {
  if (!active()) {
    return status_;
  }
  seen_s_ = std::max(seen_s_, stamp_s);
  newest_s_ = std::max(newest_s_, stamp_s);
  late_ = newest_s_ - stamp_s > settings_.sensor_timeout_s;
  noteSight(travelled_m, sight, permit);
  decide(newest_s_, "", permit);
  return status_;
}

const NavigationStatus& NavigationSupervisor::watch(double now_s, const std::string& missing,
                                                    const MotionPermit& permit) {
  if (active()) {
    noteTime(now_s);
  }
  if (active()) {
    decide(now_s, missing, permit);
  }
  return status_;
}

const NavigationStatus& NavigationSupervisor::prepare(double now_s, const std::string& doing,
                                                      const MotionPermit& permit) {
  if (active()) {
    noteTime(now_s);
  }
  if (active()) {
    seen_s_ = std::max(seen_s_, now_s);
    starting_ = doing;
    decide(now_s, "", permit);
  }
  return status_;
}

void NavigationSupervisor::noteSight(double travelled_m, const Sight& sight, const MotionPermit& permit) {
  const bool by_hand = permit.kind == MotionPermit::Kind::kManual;
  sights_in_a_row_ = sight.recognised ? std::min(sights_in_a_row_ + 1, settings_.sights_to_trust) : 0;
  if (trusted() || !seen_any_ || by_hand) {
    blind_from_m_ = travelled_m;  // what a person drives, a person sees
  }
  seen_any_ = true;
  on_path_ = on_path_ || trusted();
  sight_ = sight;
  blind_m_ = travelled_m - blind_from_m_;
}

void NavigationSupervisor::noteTime(double now_s) {
  if (now_s < newest_s_ - settings_.sensor_timeout_s - kBackwards_s) {
    fail("time went back by " + humanSeconds(newest_s_ - now_s));
    return;
  }
  if (now_s > newest_s_ + kForwards_s) {
    seen_s_ =
        now_s - settings_.sensor_timeout_s - kBackwards_s;  // what was seen is old, but nothing was silent
    holding_since_s_.reset();
  }
  newest_s_ = std::max(newest_s_, now_s);
}

void NavigationSupervisor::decide(double now_s, const std::string& missing, const MotionPermit& permit) {
  if (mustStop(now_s, missing, permit)) {
    holding_since_s_.reset();
    return;
  }
  if (!seen_any_) {
    set(NavigationMode::kStarting, starting_, 0.0);
    return;
  }
  if (mustHold(now_s, permit)) {
    return;
  }
  holding_since_s_.reset();
  drive(permit);
}

bool NavigationSupervisor::mustStop(double now_s, const std::string& missing, const MotionPermit& permit) {
  const double silent_s = now_s - seen_s_;
  if (!image_problem_.empty() || silent_s > settings_.sensor_timeout_s) {
    const bool image = missing.empty() || missing == "image";
    const std::string what = image ? (late_ ? "fresh image" : "image") : missing;
    const std::string reason =
        !image_problem_.empty() ? image_problem_ : "no " + what + " for " + humanSeconds(silent_s);
    if (silent_s > settings_.give_up_s) {
      fail(reason + "; check its topic");
    } else {
      set(NavigationMode::kStopped, reason, 0.0);
    }
    return true;
  }
  if (permit.kind == MotionPermit::Kind::kStop || permit.kind == MotionPermit::Kind::kManual) {
    set(NavigationMode::kStopped, permit.reason, 0.0);
    return true;
  }
  return false;
}

bool NavigationSupervisor::mustHold(double now_s, const MotionPermit& permit) {
  const bool obstructed = permit.kind == MotionPermit::Kind::kHold;
  if (!obstructed && mayDriveBlind()) {
    return false;
  }
  const std::string reason = obstructed ? permit.reason : whyBlind();
  holding_since_s_ = holding_since_s_.value_or(now_s);
  const double held_s = now_s - *holding_since_s_;
  if (held_s > settings_.hold_timeout_s) {
    fail(reason + ", and nothing changed for " + humanSeconds(held_s));
  } else {
    const bool starting = !obstructed && !on_path_;
    set(starting ? NavigationMode::kStarting : NavigationMode::kHolding, reason + "; waiting", 0.0);
  }
  return true;
}

bool NavigationSupervisor::mayDriveBlind() const {
  return trusted() || blind_m_ < (on_path_ ? settings_.max_blind_distance_m : settings_.max_blind_start_m);
}

std::string NavigationSupervisor::whyBlind() const {
  if (on_path_) {
    return "the path was not recognised for " + humanMetres(blind_m_);
  }
  return sight_.recognised ? "the path must be recognised in " + std::to_string(settings_.sights_to_trust) +
                                 " images in a row before the robot drives"
                           : "the path is not recognised here (is this where it begins? `localise` finds the "
                             "place; is the camera covered?)";
}

void NavigationSupervisor::drive(const MotionPermit& permit) {
  const double factor = std::min(1.0, permit.speed_factor) * speedFactor();
  const std::string more = permit.reason.empty() ? "" : "; " + permit.reason;
  if (sight_.recognised) {
    set(NavigationMode::kRepeating, "following the path by sight" + more, factor);
  } else {
    set(NavigationMode::kDegraded,
        "the path is not recognised; driving by odometry, " + humanMetres(blind_m_) + " so far" + more,
        factor);
  }
}

double NavigationSupervisor::speedFactor() const {
  if (!on_path_) {
    return std::min(settings_.blind_speed, settings_.least_speed);
  }
  if (!sight_.recognised) {
    return settings_.blind_speed;
  }
  if (!(sight_.confidence < settings_.full_confidence)) {
    return 1.0;
  }
  const double share = std::max(0.0, sight_.confidence) / settings_.full_confidence;
  return settings_.least_speed + (1.0 - settings_.least_speed) * share;
}

void NavigationSupervisor::set(NavigationMode mode, const std::string& reason, double speed_factor) {
  status_ = {mode, reason, speed_factor};
}

void NavigationSupervisor::end(NavigationMode mode, const std::string& reason) { set(mode, reason, 0.0); }

}  // namespace perennial
