#pragma once

#include <chrono>
#include <csignal>
#include <exception>
#include <iostream>
#include <string>

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "perennial/ros/master_monitor.h"

namespace perennial {

inline volatile std::sig_atomic_t g_stop_requested = 0;

/// Runs a node until Ctrl-C, SIGTERM or a shutdown by the master, and destroys it while its connections still live, so
/// that what it does last (stop the robot, finish the map) reaches the others. Exit status 1 when it cannot start, or when the
/// master was restarted: nobody can find the node any more, and whoever started it (respawn) has to start it anew.
template <typename Node>
int runNode(int argc, char** argv, const std::string& name) {
  ros::init(argc, argv, name, ros::init_options::NoSigintHandler);
  std::signal(SIGINT, [](int) { g_stop_requested = 1; });
  std::signal(SIGTERM, [](int) { g_stop_requested = 1; });
  constexpr std::chrono::milliseconds kMasterTimeout(2000);
  int status = 0;
  try {
    ros::NodeHandle nh;
    {
      Node node(nh, ros::NodeHandle("~"));
      const MasterMonitor master(kMasterTimeout);
      while (ros::ok() && g_stop_requested == 0 && !master.forgotten()) {
        ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
      }
      if (master.forgotten()) {
        std::cerr << name << " ends: the ROS master was restarted and does not know it any more" << std::endl;
        status = 1;
      }
    }
    ros::WallDuration(0.1).sleep();  // lets the last messages leave; roscpp has no call that waits for them
    ros::shutdown();
    return status;
  } catch (const std::exception& error) {
    // Not by rosconsole, which may be silent before the node has come up.
    std::cerr << name << " cannot run: " << error.what() << std::endl;
    ros::shutdown();
    return 1;
  }
}

}  // namespace perennial
