#pragma once

#include <actionlib/server/simple_action_server.h>
#include <image_transport/image_transport.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <optional>
#include <string>

#include "perennial/core/image_watch.h"
#include "perennial/core/navigation_supervisor.h"
#include "perennial/core/odometer.h"
#include "perennial/core/repeat_session.h"
#include "perennial/core/restart_watch.h"
#include "perennial/ros/command_gate.h"
#include "perennial/ros/emergency_memory.h"
#include "perennial/ros/image_queue.h"
#include "perennial/ros/live_settings.h"
#include "perennial/ros/localiser.h"
#include "perennial/ros/navigation_reporter.h"
#include "perennial/ros/repeat_navigator_settings.h"
#include "perennial/ros/repeat_run.h"
#include "perennial/ros/safety_inputs.h"
#include "perennial/ros/traversal_client.h"
#include "perennial_nav/LocalMap.h"
#include "perennial_nav/RepeatAction.h"

namespace perennial {

/// Serves the action `repeat`: drives a taught path by registering images against the local maps that
/// map_manager sends.
///
/// Subscribes image, camera_info, odom, local_maps, and what SafetyInputs lists; publishes cmd_vel and what
/// NavigationReporter lists. Callbacks run on the global queue and must be served by one thread; the command
/// gate and the safety inputs have one of their own.
class RepeatNavigator {
 public:
  /// Throws ParameterError.
  RepeatNavigator(ros::NodeHandle nh, ros::NodeHandle private_nh);
  ~RepeatNavigator();

 private:
  using Server = actionlib::SimpleActionServer<perennial_nav::RepeatAction>;

  void onGoal();
  void onPreempt();
  void onImage(const sensor_msgs::ImageConstPtr& image);
  void onOdometry(const nav_msgs::OdometryConstPtr& message);
  void onLocalMap(const perennial_nav::LocalMapConstPtr& message);
  void onTimer();

  void startRun(const perennial_nav::RepeatGoal& goal);
  void beginTraversal(double start_m, std::optional<double> travelled_m, const ros::Time& stamp);
  void processPending();
  bool registerFront(double travelled_m);
  void process(const sensor_msgs::ImageConstPtr& image, double travelled_m);
  void followHand(double travelled_m);
  void fetchLocalMapsBehind(double travelled_m);
  void drive(const NavigationStep& step, const sensor_msgs::ImageConstPtr& image);
  void report(const NavigationStep& step, const sensor_msgs::ImageConstPtr& image);
  void publishFeedback(const NavigationStep* step = nullptr);
  void watchProgress(const ros::Time& stamp);
  void completeTraversal(const ros::Time& stamp);

  // Where on the path the robot is: repeat_navigator_place.cpp.
  void beginLocalisation();
  void seekPlace(const sensor_msgs::ImageConstPtr& image, const cv::Mat& grey, double travelled_m);
  void onPlaceSought(const sensor_msgs::ImageConstPtr& image, const std::optional<PlaceGuess>& place);
  void startAt(const PlaceGuess& place, const ros::Time& stamp);
  void prepare(const std::string& doing);
  bool drivenByHand() const { return gate_.permit().kind == MotionPermit::Kind::kManual; }

  void fail(const std::string& reason);
  /// Ends the run: stops the robot and, unless it has been ended already, forgets the open traversal.
  perennial_nav::RepeatResult endRun(bool success, const std::string& reason);

  /// Whether it was still on its way when the goal came: the robot may have been carried elsewhere meanwhile.
  /// Bags have no such thing.
  bool isFromBefore(const std_msgs::Header& header) const;
  /// What navigation waits for, as the supervisor wants it.
  std::string missing() const;
  /// `what` is missing; says so when messages came, but from before the goal by their stamps.
  std::string missingSinceGoal(const std::string& what, std::size_t from_before) const;
  void publishState(const ros::Time& stamp, const NavigationStep* step = nullptr);
  void acknowledge(const sensor_msgs::ImageConstPtr& image);

  ros::NodeHandle nh_;
  RepeatNavigatorSettings settings_;
  Odometer odometer_;
  RestartWatch odometry_watch_;
  ImageQueue images_;
  ImageWatch image_watch_;
  NavigationSupervisor supervisor_;
  TraversalClient traversals_;
  Localiser localiser_;
  CommandGate gate_;
  EmergencyMemory emergency_memory_;
  SafetyInputs inputs_;
  std::unique_ptr<RepeatRun> run_;
  NavigationStep step_;  ///< the newest one; its memory is used again
  sensor_msgs::CameraInfoConstPtr camera_info_;
  std::size_t ignored_maps_ = 0;

  NavigationReporter reporter_;
  LiveSettings live_settings_;
  image_transport::ImageTransport transport_;
  image_transport::Subscriber image_subscriber_;
  ros::Subscriber camera_info_subscriber_;
  ros::Subscriber odometry_subscriber_;
  ros::Subscriber map_subscriber_;
  ros::Timer timer_;
  Server server_;
};

}  // namespace perennial
