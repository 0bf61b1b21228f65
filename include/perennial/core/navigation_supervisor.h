#pragma once

#include <optional>
#include <string>

#include "perennial/core/image_watch.h"
#include "perennial/core/motion_interlock.h"
#include "perennial/core/parameter_reader.h"
#include "perennial/core/sight.h"

namespace perennial {

struct SupervisorSettings {
  double max_blind_start_m = 0.0;     ///< the same before the path was recognised for the first time
  double max_blind_distance_m = 3.0;  ///< driven by odometry alone, at most; then the robot holds
  int sights_to_trust = 3;        ///< so many images recognised in a row end being blind; fewer may be chance
  double hold_timeout_s = 60.0;   ///< holding for so long: the goal fails
  double blind_speed = 0.5;       ///< share of the taught speed while the view is not recognised
  double least_speed = 0.4;       ///< share of the taught speed with the lowest confidence
  double full_confidence = 0.9;   ///< from this confidence on the taught speed is driven
  ImageWatchSettings camera;      ///< its keys are in the same group
  double sensor_timeout_s = 0.5;  ///< nothing seen for so long: stopped. Not in the group; as the node's own
  double give_up_s = 10.0;        ///< nothing seen for so long: failed. Not in the group; as the node's own

  /// Keys as the members are called. Throws ParameterError.
  static SupervisorSettings load(ParameterReader& reader);
};

enum class NavigationMode {
  kIdle,       ///< no goal
  kStarting,   ///< a goal, but nothing seen yet, or the path not recognised yet
  kRepeating,  ///< drives by what it sees
  kDegraded,   ///< drives by odometry, slower: the view is not recognised
  kHolding,    ///< stands, and goes on by itself: blind for too long, or something in the way
  kStopped,    ///< stands at once: data, a person or another program forbids motion; goes on when they allow
  kFinished,   ///< the goal was reached
  kFailed,     ///< the goal was given up
};

/// As on navigation_state: "idle", "starting", ...
const char* nameOf(NavigationMode mode);

struct NavigationStatus {
  NavigationMode mode = NavigationMode::kIdle;
  std::string reason;         ///< for a person; never empty
  double speed_factor = 0.0;  ///< share of the taught speed to drive with; 0: stand
};

/// Decides whether a repeat may go on, how fast, and says why. A state machine without clock, threads or ROS:
/// times are seconds of one clock of the caller's (the stamps of messages, in practice). Not thread-safe.
///
/// idle -start-> starting -the path is recognised-> repeating <-> degraded <-> holding; stopped from any of
/// these and back; finished, failed and idle end a goal. Several reasons at once: the one that forbids most
/// wins.
///
/// A robot that has not recognised the path since the goal came may stand anywhere, or have its camera
/// covered: it stands until `sights_to_trust` images in a row were recognised, unless `max_blind_start_m`
/// lets it drive so far at the least speed.
class NavigationSupervisor {
 public:
  explicit NavigationSupervisor(const SupervisorSettings& settings = {});

  /// A goal was accepted.
  void start(double now_s);
  /// An image was registered: taken at `stamp_s`, having travelled `travelled_m`. One that comes late, by the
  /// newest time heard of, lets nothing move.
  const NavigationStatus& see(double stamp_s, double travelled_m, const Sight& sight,
                              const MotionPermit& permit);
  /// To be called regularly. `missing`: what navigation waits for, if it waits for anything: "image",
  /// "odometry", ...
  const NavigationStatus& watch(double now_s, const std::string& missing, const MotionPermit& permit);
  /// Before the first image to drive by: the robot stands and is busy with what it has, so nothing is
  /// missing. `doing`: for a person; it stays the reason for starting.
  const NavigationStatus& prepare(double now_s, const std::string& doing, const MotionPermit& permit);
  /// The robot was found on the path: it need not be recognised there once more before it drives.
  void trustPlace() { on_path_ = true; }
  /// Images came that cannot be used, and why; empty: they can again.
  void setImageProblem(const std::string& problem) { image_problem_ = problem; }

  void finish(const std::string& reason) { end(NavigationMode::kFinished, reason); }
  void fail(const std::string& reason) { end(NavigationMode::kFailed, reason); }
  void rest(const std::string& reason) { end(NavigationMode::kIdle, reason); }

  const NavigationStatus& status() const { return status_; }
  /// Whether there is a goal.
  bool active() const;

 private:
  void noteSight(double travelled_m, const Sight& sight, const MotionPermit& permit);
  bool trusted() const { return sights_in_a_row_ >= settings_.sights_to_trust; }
  void noteTime(double now_s);
  void decide(double now_s, const std::string& missing, const MotionPermit& permit);
  bool mustStop(double now_s, const std::string& missing, const MotionPermit& permit);
  bool mustHold(double now_s, const MotionPermit& permit);
  bool mayDriveBlind() const;
  std::string whyBlind() const;
  void drive(const MotionPermit& permit);
  double speedFactor() const;
  void set(NavigationMode mode, const std::string& reason, double speed_factor);
  void end(NavigationMode mode, const std::string& reason);

  SupervisorSettings settings_;
  NavigationStatus status_{NavigationMode::kIdle, "waiting for a goal", 0.0};
  double newest_s_ = 0.0;  ///< newest time heard of
  double seen_s_ = 0.0;    ///< stamp of the newest image used, or of the goal
  bool late_ = false;      ///< it was old already when it came
  bool seen_any_ = false;
  bool on_path_ = false;  ///< whether the path was recognised since the goal came
  std::string starting_;  ///< reason for a robot that has not seen anything yet
  Sight sight_;
  int sights_in_a_row_ = 0;    ///< newest images that were recognised, counted up to sights_to_trust
  double blind_from_m_ = 0.0;  ///< travelled distance where the path was last recognised for certain
  double blind_m_ = 0.0;       ///< driven since
  std::optional<double> holding_since_s_;
  std::string image_problem_;
};

}  // namespace perennial
