#pragma once

#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>

#include <functional>

#include "perennial/core/repeat_session.h"
#include "perennial_nav/ExtractionConfig.h"
#include "perennial_nav/RegistrationConfig.h"
#include "perennial_nav/SteeringConfig.h"

namespace perennial {

/// Offers a repeat's settings to dynamic_reconfigure. Registration and steering change at once, also while
/// the robot drives; extraction only between goals, since a run keeps the settings its map was taught with.
class LiveSettings {
 public:
  /// `settings` is changed in place and must outlive this; `session` gives the running session, nullptr when
  /// there is none.
  LiveSettings(const ros::NodeHandle& private_nh, RepeatSettings& settings,
               std::function<RepeatSession*()> session);

 private:
  RepeatSettings& settings_;
  std::function<RepeatSession*()> session_;
  dynamic_reconfigure::Server<perennial_nav::ExtractionConfig> extraction_;
  dynamic_reconfigure::Server<perennial_nav::RegistrationConfig> registration_;
  dynamic_reconfigure::Server<perennial_nav::SteeringConfig> steering_;
};

}  // namespace perennial
