#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "perennial/core/parameter_reader.h"
#include "perennial/park/camera_model.h"
#include "perennial/park/conditions.h"
#include "perennial/park/loop_path.h"
#include "perennial/park/precipitation.h"
#include "perennial/park/renderer.h"
#include "perennial/park/robot_model.h"
#include "perennial/park/scripted_driver.h"

namespace perennial::park {

struct ParkSettings {
  LoopSettings loop;
  RobotSettings robot;
  DriverSettings driver;
  CameraSettings camera;
  int image_rate_hz = 15;
  int odometry_rate_hz = 60;  ///< a multiple of the image rate
  bool colour = false;        ///< images in colour, CV_8UC3, instead of CV_8UC1
  int noise_seed = 1;         ///< of the camera's and the odometry's noise

  /// Keys: loop_length_m, loop_shape_seed, image_rate_hz, odometry_rate_hz, colour, noise_seed, and those of
  /// robot, driver and camera. Throws ParameterError.
  static ParkSettings load(ParameterReader& reader);
};

/// What happened until the next image.
struct ParkFrame {
  std::int64_t stamp_ns = 0;       ///< of the image; simulated time
  cv::Mat image;                   ///< CV_8UC1 (or CV_8UC3, blue-green-red), the receiver's own
  std::vector<Odometry> odometry;  ///< since the last frame; the last one has the image's stamp
  Pose true_pose;                  ///< in the park's frame, at the image's stamp
  Velocity true_velocity;
  double arc_length_m = 0.0;  ///< of the point of the path nearest to the robot
  double lateral_m = 0.0;     ///< of the robot from the path, positive to the left
};

/// The whole embedded world in one process and in simulated time: park, robot, camera and driver. The same
/// settings, conditions and commands give the same images and odometry. Use:
///
///     ParkSimulation park(settings, conditions);
///     while (...) {
///       const ParkFrame frame = park.step();
///       park.command(steer(...));
///     }
///
/// All calls must come from one thread.
class ParkSimulation {
 public:
  ParkSimulation(const ParkSettings& settings, const Conditions& conditions);

  /// Puts the robot at the start of the path, this far to its left (m) and turned this far to the left (rad).
  /// Odometry starts anew from zero; time goes on; the camera's exposure settles before the next image.
  void place(double lateral_m, double heading_rad);
  /// Changes the conditions. Simulated time jumps to a later date; an earlier date changes the park only (see
  /// `worldTime()`), because stamps must never go back.
  void setConditions(const Conditions& conditions);
  void command(const Velocity& velocity);
  /// Goes on to the next image: as many ticks as there are between two of them, then look().
  ParkFrame step();
  /// Goes on by one period of the odometry only.
  Odometry tick();
  /// What the camera sees now. The frame holds no odometry.
  ParkFrame look();
  int ticksPerImage() const { return settings_.odometry_rate_hz / settings_.image_rate_hz; }

  /// Lets the scripted driver drive from the start of the path, or stops it.
  void setDriver(bool drives);
  bool driverDrives() const { return drives_; }
  /// The driver is round and has let go.
  bool driverFinished() const { return driver_.finished(); }
  /// What the driver wants now; meaningful while it drives. ParkSimulation does not send it by itself.
  Velocity driverCommand();

  /// Stamp of the last frame.
  std::int64_t nowNs() const { return now_ns_; }
  /// Date and time in the park, seconds since 1970: simulated time plus an offset that is zero until an
  /// earlier date is set.
  double worldTime() const;
  Conditions conditions() const;
  const LoopPath& path() const { return path_; }
  const ParkSettings& settings() const { return settings_; }
  const RobotModel& robot() const { return robot_; }
  const ExposureState& exposure() const { return camera_.state(); }

 private:
  std::int64_t tickNs(std::int64_t tick) const;
  CameraPose cameraPose() const;
  cv::Mat shoot();
  void settleExposure();
  void restartClock(std::int64_t now_ns);

  ParkSettings settings_;
  Conditions conditions_;
  LoopPath path_;
  Renderer renderer_;
  CameraModel camera_;
  RobotModel robot_;
  ScriptedDriver driver_;
  bool drives_ = false;
  bool exposure_settled_ = false;
  std::int64_t start_ns_ = 0;  ///< stamp of tick 0
  std::int64_t tick_ = 0;      ///< of the odometry since then
  std::int64_t now_ns_ = 0;
  double world_offset_s_ = 0.0;
};

}  // namespace perennial::park
