#pragma once

#include <actionlib/server/simple_action_server.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/Twist.h>
#include <image_transport/image_transport.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <ros/ros.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "perennial/core/image_watch.h"
#include "perennial/core/odometer.h"
#include "perennial/core/restart_watch.h"
#include "perennial/core/teach_session.h"
#include "perennial/ros/image_queue.h"
#include "perennial_nav/ExtractionConfig.h"
#include "perennial_nav/TeachAction.h"

namespace perennial {

/// Parameters of the node itself; groups: extraction, teaching, odometer.
struct TeachRecorderSettings {
  std::string map_folder;          ///< where maps are stored; required
  std::string camera = "";         ///< name stored with the map; empty: the images' frame
  bool every_image = false;        ///< never drop an image, however long its odometry takes to come (bags)
  ImageWatchSettings image_watch;  ///< its keys are the node's own

  static TeachRecorderSettings load(ParameterReader& reader);
};

/// Serves the action `teach`: while a goal is active, images, odometry and commands become a map. Preempting
/// the goal, or stopping the node, finishes the map.
///
/// Subscribes image, odom, cmd_vel; publishes taught_path, processed, diagnostics. All callbacks run on the
/// global queue and must be served by one thread.
class TeachRecorder {
 public:
  /// Throws ParameterError.
  TeachRecorder(ros::NodeHandle nh, ros::NodeHandle private_nh);
  /// Finishes a map that is being taught.
  ~TeachRecorder();

 private:
  using Server = actionlib::SimpleActionServer<perennial_nav::TeachAction>;

  void onGoal();
  void onPreempt();
  void onImage(const sensor_msgs::ImageConstPtr& image);
  void onOdometry(const nav_msgs::OdometryConstPtr& message);
  void onCommand(const geometry_msgs::TwistConstPtr& message);
  void onReconfigure(perennial_nav::ExtractionConfig& config, uint32_t level);

  void begin(const perennial_nav::TeachGoal& goal);
  void processPending();
  void process(const sensor_msgs::ImageConstPtr& image, double travelled_m);
  /// Ends the session; the result tells whether the map was stored.
  perennial_nav::TeachResult finish();
  std::unique_ptr<TeachSession> endSession();
  void abort(const std::string& reason);
  void publishProgress();
  void acknowledge(const sensor_msgs::ImageConstPtr& image);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  ros::NodeHandle nh_;
  ros::NodeHandle private_nh_;
  TeachRecorderSettings settings_;
  TeachSettings teach_settings_;
  ExtractionSettings extraction_;

  std::unique_ptr<TeachSession> session_;
  Odometer odometer_;
  RestartWatch odometry_watch_;
  ImageQueue images_;
  ImageWatch image_watch_;
  std::optional<Velocity> last_command_;
  geometry_msgs::PoseStamped newest_pose_;
  nav_msgs::Path path_;
  std::size_t refused_images_ = 0;
  std::string last_refusal_;

  image_transport::ImageTransport transport_;
  image_transport::Subscriber image_subscriber_;
  ros::Subscriber odometry_subscriber_;
  ros::Subscriber command_subscriber_;
  ros::Publisher path_publisher_;
  ros::Publisher processed_publisher_;
  dynamic_reconfigure::Server<perennial_nav::ExtractionConfig> reconfigure_;
  diagnostic_updater::Updater diagnostics_;
  ros::Timer diagnostics_timer_;
  Server server_;
};

}  // namespace perennial
