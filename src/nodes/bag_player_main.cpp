#include <exception>
#include <iostream>

#include <ros/ros.h>

#include "perennial/ros/bag_player.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "bag_player");
  try {
    const ros::NodeHandle nh;
    return perennial::BagPlayer(nh, ros::NodeHandle("~")).run() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "bag_player: " << error.what() << std::endl;
    return 1;
  }
}
