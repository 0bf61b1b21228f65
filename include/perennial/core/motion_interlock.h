#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "perennial/core/parameter_reader.h"
#include "perennial/core/path_profile.h"

namespace perennial {

struct DeadManSettings {
  enum class Kind { kNone, kJoy, kHeartbeat };

  Kind kind = Kind::kNone;
  int button = 5;          ///< of the joystick, to be held down; teleop_node has 4
  double timeout_s = 0.5;  ///< without a sign of life for so long the robot stops

  /// Keys as the members are called; kind: none, joy, heartbeat. Throws ParameterError.
  static DeadManSettings load(ParameterReader& reader);
};

struct ObstacleSettings {
  bool range = false;            ///< whether a range finder must be there
  bool scan = false;             ///< whether a laser scanner must be there
  bool flag = false;             ///< whether a boolean detector must be there
  double slow_distance_m = 1.5;  ///< from here on the robot slows down
  double stop_distance_m = 0.5;  ///< here it stands
  double least_speed = 0.2;      ///< share of the speed just before it stands, so that it gets there
  double half_width_m = 0.4;     ///< of the corridor ahead of the scanner in which something is in the way
  double timeout_s = 0.5;        ///< a sensor silent for so long stops the robot

  /// Keys as the members are called. Throws ParameterError, also when slowing down begins behind the stop.
  static ObstacleSettings load(ParameterReader& reader);
};

struct OverrideSettings {
  double timeout_s = 0.3;  ///< a command by hand holds so long
  double release_s = 1.0;  ///< the repeat goes on when no command by hand, or by a stranger, came for so long

  /// Keys as the members are called. Throws ParameterError.
  static OverrideSettings load(ParameterReader& reader);
};

struct InterlockSettings {
  DeadManSettings dead_man;
  ObstacleSettings obstacles;
  OverrideSettings teleop;
};

/// What the robot may do at a moment, and why.
struct MotionPermit {
  enum class Kind {
    kGo,      ///< drive, at most `speed_factor` of the speed wanted
    kHold,    ///< come to a stand and wait
    kManual,  ///< a person drives: `manual`
    kStop,    ///< stand still at once
  };

  Kind kind = Kind::kGo;
  double speed_factor = 1.0;
  std::string reason;  ///< for a person; empty when nothing is in the way
  Velocity manual;

  /// Whether the robot is driven slower than it wants to, or not at all.
  bool hinders() const { return kind != Kind::kGo || speed_factor < 1.0; }
};

enum class EmergencyStop { kTopic, kService };
enum class ObstacleSensor { kRange, kScan, kFlag };

/// Gathers everything that forbids motion from outside of navigation: emergency stops, a dead man's signal,
/// obstacles, a person's commands, strangers on the command topic, a master that is gone. Knows no clock:
/// times are seconds of one clock of the caller's; after that clock has gone back nothing counts as fresh.
/// Not thread-safe.
class MotionInterlock {
 public:
  explicit MotionInterlock(const InterlockSettings& settings = {}) : settings_(settings) {}

  /// Engaged: the robot stops. Released: it goes on only after resume(), for releasing a stop must not start
  /// a robot.
  void setEmergencyStop(EmergencyStop source, bool engaged);
  /// There was an emergency stop: the robot goes on only after resume().
  void latchEmergencyStop() { emergency_latched_ = true; }
  /// Whether one is engaged, or was and resume() has not been called.
  bool emergencyStopped() const { return emergency_latched_; }
  /// Whether the robot may go on; not while an emergency stop is engaged.
  bool resume();

  /// A sign of life: `held`: whether the button is down (a heartbeat: always). `stamp_s`: when that was so,
  /// by the clock of the one who says it; 0: unknown, taken as the present. From there on its time-out runs,
  /// so late messages do not count as news; a stamp further in the future than the time-out is not believed,
  /// and counts as no sign.
  void deadMan(bool held, double stamp_s, double now_s);
  /// Distance of the nearest thing in the way; infinity when there is none, NaN when the sensor does not
  /// know. `stamp_s` as above.
  void obstacle(ObstacleSensor sensor, double distance_m, double stamp_s, double now_s);
  /// A velocity commanded by a person. One that is not finite counts as zero.
  void teleop(const Velocity& velocity, double now_s);
  /// Somebody else has published a command.
  void strangerCommanded(const std::string& name, double now_s);
  /// What strangers and people commanded before a repeat does not matter for it.
  void forgetCommands();
  void setMasterAlive(bool alive) { master_alive_ = alive; }

  MotionPermit at(double now_s) const;

 private:
  struct Reading {
    double distance_m = std::numeric_limits<double>::quiet_NaN();
    std::optional<double> stamp_s;
  };

  std::string emergency() const;
  std::string deadManProblem(double now_s) const;
  std::string sensorProblem(double now_s) const;
  bool wanted(std::size_t sensor) const;
  MotionPermit byObstacles() const;

  InterlockSettings settings_;
  std::array<bool, 2> emergency_engaged_{};
  bool emergency_latched_ = false;
  bool dead_man_held_ = false;
  std::optional<double> dead_man_stamp_s_;
  std::array<Reading, 3> readings_;
  Velocity manual_;
  std::optional<double> manual_stamp_s_;
  std::string stranger_;
  std::optional<double> stranger_stamp_s_;
  bool master_alive_ = true;
};

/// A laser scan; ray i points `angle_min + i * angle_increment` rad to the left of straight on.
struct ScanView {
  const float* ranges = nullptr;  ///< `count` of them, m
  std::size_t count = 0;
  double angle_min = 0.0;
  double angle_increment = 0.0;
  double range_min = 0.0;
  double range_max = 0.0;
};

/// What the robot drives through: |y| <= half_width_m, x > 0.
struct Corridor {
  double half_width_m = 0.4;
  double depth_m = 1.5;  ///< how far it must be seen
};

/// Distance ahead of the nearest point of a scan within the corridor; infinity when there is none; NaN when
/// the scan does not know: when no ray that is still in the corridor at its depth holds a valid reading.
///
/// As REP 117 has it, +inf and readings beyond range_max are nothing within reach, -inf is something too near
/// to measure, taken for range_min, and NaN a reading that failed. A positive reading below range_min is
/// taken for what it says, something very near; zero or less for a failed one, for so many drivers say it.
/// Without a range_max above range_min and zero no reading is valid.
double nearestInCorridor(const ScanView& scan, const Corridor& corridor);

}  // namespace perennial
