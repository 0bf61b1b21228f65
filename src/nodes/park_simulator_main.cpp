#include <ros/ros.h>

#include <csignal>
#include <exception>
#include <iostream>

#include "perennial/ros/park_simulator.h"

namespace {

volatile std::sig_atomic_t g_stop_requested = 0;

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "park_simulator", ros::init_options::NoSigintHandler);
  std::signal(SIGINT, [](int) { g_stop_requested = 1; });
  std::signal(SIGTERM, [](int) { g_stop_requested = 1; });
  try {
    perennial::ParkSimulator(ros::NodeHandle(), ros::NodeHandle("~")).run([] {
      return g_stop_requested != 0;
    });
    return 0;
  } catch (const std::exception& error) {
    // Not through ROS, whose log is silent by now: nobody would learn which parameter is wrong.
    std::cerr << "park_simulator: " << error.what() << std::endl;
    return 1;
  }
}
