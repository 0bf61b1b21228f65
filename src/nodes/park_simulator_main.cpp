#include <ros/ros.h>

#include <csignal>

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
    ROS_FATAL("%s", error.what());
    return 1;
  }
}
