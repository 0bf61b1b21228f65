#include <ros/ros.h>

#include "perennial/ros/bag_player.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "bag_player");
  try {
    const ros::NodeHandle nh;
    return perennial::BagPlayer(nh, ros::NodeHandle("~")).run() ? 0 : 1;
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
}
