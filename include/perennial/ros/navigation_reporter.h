#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/Twist.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <cstddef>

#include "perennial/core/navigation_supervisor.h"
#include "perennial/core/note_limit.h"
#include "perennial/core/repeat_session.h"
#include "perennial/ros/repeat_run.h"
#include "perennial_nav/NavigationState.h"

namespace perennial {

/// What the navigator tells others beside the registrations: navigation_state (latched), matches (drawn only
/// while somebody subscribes), processed, diagnostics; and, in the log, changes of the state: of each state
/// the first few in a traversal, so that the log is bounded by the traversals, not by the images.
class NavigationReporter {
 public:
  NavigationReporter(ros::NodeHandle nh, ros::NodeHandle private_nh);

  /// `run`: the goal being served; `step`: what the newest image gave; nullptr when there is none.
  void state(const ros::Time& stamp, const NavigationStatus& status, const geometry_msgs::Twist& command,
             const RepeatRun* run, const NavigationStep* step);
  void matches(const NavigationStep& step, const sensor_msgs::ImageConstPtr& image, const RepeatRun& run);
  /// From here on the log has room again.
  void beginTraversal() { log_.begin(); }
  /// Done with an image; `drives`: whether the command is meant for it.
  void processed(const std_msgs::Header& header, bool drives, const geometry_msgs::Twist& command);

  /// To be called regularly; numbers for diagnostics.
  void update(std::size_t dropped_images, std::size_t ignored_maps, bool has_camera_info);

 private:
  void log(const std::string& mode, const std::string& reason);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  image_transport::ImageTransport transport_;
  ros::Publisher state_publisher_;
  ros::Publisher processed_publisher_;
  image_transport::Publisher matches_publisher_;
  diagnostic_updater::Updater diagnostics_;
  perennial_nav::NavigationState state_;
  NoteLimit log_;
  std::size_t dropped_images_ = 0;
  std::size_t ignored_maps_ = 0;
  bool has_camera_info_ = false;
};

}  // namespace perennial
