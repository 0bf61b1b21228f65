#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/Twist.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <functional>
#include <string>
#include <vector>

#include "perennial/park/park_simulation.h"
#include "perennial/ros/lockstep_gate.h"
#include "perennial_nav/SetPark.h"

namespace perennial {

/// Parameters of the node; those of the groups `park` and `conditions` are ParkSettings and Conditions.
struct ParkSimulatorSettings {
  std::vector<std::string> lockstep;  ///< names in `processed` to wait for after each image; empty: none
  double lockstep_timeout_s = 5.0;    ///< real time after which a node that does not answer is not waited for
  double real_time_factor = 1.0;      ///< without lockstep: simulated seconds per real second
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  std::string camera_frame = "camera";
  bool drive = false;  ///< whether the scripted driver drives from the beginning
  /// The robot's and the camera's drivers stand between this world and the nodes: the scripted driver
  /// commands the robot's driver (topic driver_cmd_vel), not the robot, and lockstep leaves the drivers the
  /// time they need.
  bool through_drivers = false;

  /// Keys: lockstep (names separated by commas or spaces), and the other members'. Throws ParameterError.
  static ParkSimulatorSettings load(ParameterReader& reader);
};

/// The embedded world as a node: publishes /clock, image_raw, camera_info, odom, ground_truth, loop_path, tf
/// and diagnostics; subscribes cmd_vel and processed; serves set_park. docs/park.md describes all of them.
///
/// Simulates in run(), which serves its callbacks (global queue) in between: everything happens in one
/// thread, and a callback never meets a half-done step.
class ParkSimulator {
 public:
  /// Throws ParameterError, and Error when the park cannot be rendered here.
  ParkSimulator(ros::NodeHandle nh, ros::NodeHandle private_nh);

  /// Simulates until `stop` or until ROS shuts down.
  void run(const std::function<bool()>& stop);

 private:
  void step();
  void runThroughDrivers();
  void awaitNodes();
  void awaitAnswers();
  void keepPace();
  /// Serves callbacks until `done`, stop or the real time; true when done.
  bool serveUntil(const std::function<bool()>& done, const ros::WallTime& deadline);

  void onCommand(const geometry_msgs::Twist& message);
  bool onSetPark(perennial_nav::SetPark::Request& request, perennial_nav::SetPark::Response& response);

  void drive();
  void publishTick(const park::Odometry& odometry);
  void publishOdometry(const park::Odometry& odometry);
  void publishTruth(const park::ParkFrame& frame);
  void publishImage(const park::ParkFrame& frame);
  void publishClock(std::int64_t stamp_ns);
  void publishLoop();
  void publishCameraMount();
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  ros::NodeHandle nh_;
  ros::NodeHandle private_nh_;
  ParkSimulatorSettings settings_;
  park::ParkSimulation simulation_;
  LockstepGate gate_;
  std::function<bool()> stop_ = [] { return false; };
  ros::WallTime next_image_;  ///< when it is due without lockstep
  ros::WallTime last_image_;
  double images_per_s_ = 0.0;
  std::size_t images_ = 0;
  std::size_t refused_commands_ = 0;
  std::size_t timeouts_ = 0;
  double lateral_m_ = 0.0;

  image_transport::ImageTransport transport_;
  image_transport::CameraPublisher camera_publisher_;
  ros::Publisher clock_publisher_, odometry_publisher_, truth_publisher_, loop_publisher_, command_publisher_;
  ros::Subscriber command_subscriber_, processed_subscriber_;
  ros::ServiceServer service_;
  tf2_ros::TransformBroadcaster transforms_;
  tf2_ros::StaticTransformBroadcaster static_transforms_;
  diagnostic_updater::Updater diagnostics_;
};

}  // namespace perennial
