#pragma once

#include <ros/node_handle.h>

#include "perennial/core/drivers/velocity_limiter.h"
#include "perennial/core/motion_interlock.h"
#include "perennial/core/navigation_supervisor.h"
#include "perennial/core/odometer.h"
#include "perennial/core/parameter_reader.h"
#include "perennial/core/place_finder.h"
#include "perennial/core/repeat_session.h"

namespace perennial {

/// Every parameter of the navigator: those of the node itself and its groups, as in
/// config/repeat_navigator.yaml.
struct RepeatNavigatorSettings {
  bool every_image = false;       ///< register every image, in order (bags); else skip to the newest (robots)
  double sensor_timeout_s = 0.5;  ///< images or odometry older than this do not move the robot
  double give_up_s = 10.0;        ///< sensors or local maps missing for so long: the goal fails
  double stall_timeout_s =
      5.0;  ///< driving for so long without the odometry moving: the goal fails; 0: never

  RepeatSettings repeat;              ///< groups extraction, registration, steering, along_path
  OdometerSettings odometer;          ///< group odometer
  LocalisationSettings localisation;  ///< group localisation
  SupervisorSettings supervisor;      ///< group supervisor, with the time-outs above
  VelocityLimits limits;              ///< group limits
  InterlockSettings interlock;        ///< groups dead_man, obstacles, teleop

  /// The parameters of the node itself.
  static RepeatNavigatorSettings load(ParameterReader& reader);
  /// All of them. Throws ParameterError.
  static RepeatNavigatorSettings load(const ros::NodeHandle& private_nh);
};

}  // namespace perennial
