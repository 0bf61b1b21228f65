#include "perennial/ros/drivers/node_main.h"

#include <ros/console.h>
#include <ros/init.h>

#include <csignal>

#include "perennial/core/error.h"

namespace perennial {
namespace {

void requestEnd(int) { ros::requestShutdown(); }

}  // namespace

void endSpinningOnSignals() {
  std::signal(SIGINT, requestEnd);
  std::signal(SIGTERM, requestEnd);
}

int runNode(void (*node)()) {
  const ros::NodeHandle keeps_the_console_open;  // the end of the last handle ends logging, too
  try {
    node();
    return 0;
  } catch (const Error& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
}

}  // namespace perennial
