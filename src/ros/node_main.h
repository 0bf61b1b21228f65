#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <chrono>
#include <csignal>
#include <exception>
#include <iostream>
#include <string>

#include "perennial/ros/master_monitor.h"

namespace perennial {

inline volatile std::sig_atomic_t g_stop_requested = 0;

/// Connects to ROS and waits for the master, which roscpp would do deaf to Ctrl-C. False when it was stopped
/// meanwhile.
inline bool connectToMaster(int argc, char** argv, const std::string& name) {
  ros::init(argc, argv, name, ros::init_options::NoSigintHandler);
  std::signal(SIGINT, [](int) { g_stop_requested = 1; });
  std::signal(SIGTERM, [](int) { g_stop_requested = 1; });
  for (bool announced = false; !ros::master::check(); announced = true) {
    if (g_stop_requested != 0) {
      return false;
    }
    if (!announced) {
      std::cerr << name << " waits for the ROS master at " << ros::master::getURI() << std::endl;
    }
    ros::WallDuration(0.2).sleep();
  }
  return true;
}

/// Runs `body(nh)`, which returns an exit status and ends when g_stop_requested is set, as a node. Exit
/// status 1 when it throws.
template <typename Body>
int runBody(int argc, char** argv, const std::string& name, const Body& body) {
  try {
    if (!connectToMaster(argc, argv, name)) {
      return 0;
    }
    ros::NodeHandle nh;
    const int status = body(nh);
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

/// Runs a node until Ctrl-C, SIGTERM or a shutdown by the master, and destroys it while its connections still
/// live, so that what it does last (stop the robot, finish the map) reaches the others. Exit status 1 when it
/// cannot start, or when the master was restarted: nobody can find the node any more, and whoever started it
/// (respawn) has to start it anew.
template <typename Node>
int runNode(int argc, char** argv, const std::string& name) {
  return runBody(argc, argv, name, [&name](const ros::NodeHandle& nh) {
    constexpr std::chrono::milliseconds kMasterTimeout(2000);
    Node node(nh, ros::NodeHandle("~"));
    const MasterMonitor master(kMasterTimeout);
    while (ros::ok() && g_stop_requested == 0 && !master.forgotten()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
    }
    if (master.forgotten()) {
      std::cerr << name << " ends: the ROS master was restarted and does not know it any more" << std::endl;
      return 1;
    }
    return 0;
  });
}

}  // namespace perennial
