#pragma once

#include <ros/node_handle.h>

#include <string>

namespace perennial {

/// Makes Ctrl-C, and the SIGTERM that others send, end ros::spin() instead of the process, so that
/// destructors stop the hardware. To be called after ros::init with ros::init_options::NoSigintHandler and
/// the first node handle.
void endSpinningOnSignals();

/// Runs `node` and reports a wrong parameter as an error that ends the node. Returns the process' exit
/// status.
int runNode(void (*node)());

}  // namespace perennial
