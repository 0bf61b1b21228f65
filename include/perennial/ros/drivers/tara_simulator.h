#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/Image.h>

#include <functional>
#include <map>
#include <string>

#include "perennial/core/parameter_reader.h"
#include "perennial/ros/drivers/tara_world.h"
#include "perennial_nav/InjectFault.h"

namespace perennial {

struct TaraSimulatorSettings {
  std::string folder;  ///< where the simulated /sys, /dev and pictures go; must not exist with other content
  int width = 752;
  int height = 480;
  bool from_topic =
      false;  ///< pictures come from the topic `image`, one frame each; otherwise a moving pattern
  int disparity_px = 10;  ///< the right view is the left one moved so far

  static TaraSimulatorSettings load(ParameterReader& reader);
};

/// What a simulated TARA sees, and what is wrong with it: makes the folder that tara_preload presents as
/// devices to the driver, and fills it with pictures. Publishes `~exposure` and `~brightness`
/// (std_msgs/UInt32) as the driver set them. Faults by the service `~inject_fault`. Everything runs on the
/// spinning thread.
class TaraSimulator {
 public:
  TaraSimulator(ros::NodeHandle nh, ros::NodeHandle private_nh, const TaraSimulatorSettings& settings);
  ~TaraSimulator();

 private:
  void plug(bool in);
  void defineFaults();
  bool injectFault(perennial_nav::InjectFault::Request& request,
                   perennial_nav::InjectFault::Response& response);
  void onImage(const sensor_msgs::ImageConstPtr& image);
  void showPattern();
  void publishState();

  const TaraSimulatorSettings settings_;
  TaraWorld* world_;
  std::map<std::string, std::function<void(double)>> fault_setters_;
  ros::Publisher exposure_publisher_;
  ros::Publisher brightness_publisher_;
  ros::Subscriber image_subscriber_;
  ros::WallTimer pattern_timer_;
  ros::WallTimer state_timer_;
  ros::ServiceServer fault_service_;
};

}  // namespace perennial
