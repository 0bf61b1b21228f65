#include "perennial/ros/park_simulator.h"
#include "ros/node_main.h"

int main(int argc, char** argv) {
  return perennial::runBody(argc, argv, "park_simulator", [](const ros::NodeHandle& nh) {
    perennial::ParkSimulator(nh, ros::NodeHandle("~")).run([] { return perennial::g_stop_requested != 0; });
    return 0;
  });
}
