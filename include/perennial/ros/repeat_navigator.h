#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <actionlib/server/simple_action_server.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <image_transport/image_transport.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>

#include "perennial/core/odometer.h"
#include "perennial/core/repeat_session.h"
#include "perennial/ros/command_gate.h"
#include "perennial/ros/image_queue.h"
#include "perennial/ros/traversal_client.h"
#include "perennial_nav/ExtractionConfig.h"
#include "perennial_nav/LocalMap.h"
#include "perennial_nav/NavigationState.h"
#include "perennial_nav/RegistrationConfig.h"
#include "perennial_nav/RepeatAction.h"
#include "perennial_nav/SteeringConfig.h"

namespace perennial {

/// Parameters of the node itself; groups: extraction, registration, steering, odometer.
struct RepeatNavigatorSettings {
  bool every_image = false;       ///< register every image, in order (bags); else skip to the newest (robots)
  double sensor_timeout_s = 0.5;  ///< images or odometry older than this do not move the robot
  double give_up_s = 10.0;        ///< sensors or local maps missing for so long: the goal fails
  double stall_timeout_s = 5.0;   ///< driving for so long without the odometry moving: the goal fails; 0: never

  static RepeatNavigatorSettings load(ParameterReader& reader);
};

/// Serves the action `repeat`: drives a taught path by registering images against the local maps that map_manager sends.
///
/// Subscribes image, camera_info, odom, local_maps; publishes cmd_vel, registration, navigation_state, matches (drawn only
/// when somebody subscribes), processed, diagnostics. Callbacks run on the global queue and must be served by one thread; the
/// command gate watches from its own.
class RepeatNavigator {
 public:
  /// Throws ParameterError.
  RepeatNavigator(ros::NodeHandle nh, ros::NodeHandle private_nh);
  ~RepeatNavigator();

 private:
  using Server = actionlib::SimpleActionServer<perennial_nav::RepeatAction>;

  /// A goal being served.
  struct Run {
    perennial_nav::RepeatGoal goal;
    std::unique_ptr<RepeatSession> session;
    std::uint32_t number = 1;         ///< of the current traversal, from 1
    double start_m = 0.0;             ///< where along the path the current traversal began
    double driven_m = 0.0;            ///< in the traversals before the current one
    double travelled_m = 0.0;         ///< by the odometer, at the newest image
    ros::Time newest_stamp;           ///< of the newest image processed, or of the goal
    double progress_m = 0.0;          ///< travelled distance when the robot last moved
    ros::Time progress_stamp;
    std::map<std::uint32_t, perennial_nav::LocalMapConstPtr> messages;  ///< local maps held, for their images
  };

  void onGoal();
  void onPreempt();
  void onImage(const sensor_msgs::ImageConstPtr& image);
  void onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info);
  void onOdometry(const nav_msgs::OdometryConstPtr& message);
  void onLocalMap(const perennial_nav::LocalMapConstPtr& message);
  void onTimer();

  void startRun(const perennial_nav::RepeatGoal& goal);
  void beginTraversal(double start_m, std::optional<double> travelled_m, const ros::Time& stamp);
  void processPending();
  void process(const sensor_msgs::ImageConstPtr& image, double travelled_m);
  void send(const NavigationStep& step, const sensor_msgs::ImageConstPtr& image);
  void watchProgress(const NavigationStep& step, const ros::Time& stamp);
  void completeTraversal(const ros::Time& stamp);

  void fail(const std::string& reason);
  /// Ends the run: stops the robot and, unless it has been ended already, forgets the open traversal.
  perennial_nav::RepeatResult endRun(bool success, const std::string& reason);

  void setState(const std::string& state, const std::string& reason);
  void publishState(const ros::Time& stamp, const NavigationStep* step);
  void publishMatches(const NavigationStep& step, const sensor_msgs::ImageConstPtr& image);
  void acknowledge(const sensor_msgs::ImageConstPtr& image);
  std::optional<double> focalLength(int image_width) const;
  void setUpReconfigure();
  void setUpDiagnostics();
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  ros::NodeHandle nh_;
  ros::NodeHandle private_nh_;
  RepeatNavigatorSettings settings_;
  RepeatSettings repeat_settings_;
  Odometer odometer_;
  ImageQueue images_;
  TraversalClient traversals_;
  CommandGate gate_;
  std::unique_ptr<Run> run_;
  NavigationStep step_;  ///< the newest one; its memory is used again
  sensor_msgs::CameraInfoConstPtr camera_info_;
  std::string state_ = perennial_nav::NavigationState::IDLE;
  std::string reason_;
  std::size_t ignored_maps_ = 0;

  image_transport::ImageTransport transport_;
  image_transport::Subscriber image_subscriber_;
  ros::Subscriber camera_info_subscriber_;
  ros::Subscriber odometry_subscriber_;
  ros::Subscriber map_subscriber_;
  ros::Publisher registration_publisher_;
  ros::Publisher state_publisher_;
  ros::Publisher processed_publisher_;
  image_transport::Publisher matches_publisher_;
  dynamic_reconfigure::Server<perennial_nav::ExtractionConfig> extraction_server_;
  dynamic_reconfigure::Server<perennial_nav::RegistrationConfig> registration_server_;
  dynamic_reconfigure::Server<perennial_nav::SteeringConfig> steering_server_;
  diagnostic_updater::Updater diagnostics_;
  ros::Timer timer_;
  Server server_;
};

}  // namespace perennial
