#pragma once

#include <ros/ros.h>

#include "perennial/ros/command_gate.h"

namespace perennial {

/// Remembers an emergency stop beyond the node's death, on the parameter server (`emergency_stopped`): a
/// node that is started anew stands until somebody calls `resume`. Not thread-safe.
class EmergencyMemory {
 public:
  /// Stops the gate when the node died while an emergency stop was on.
  EmergencyMemory(CommandGate& gate, ros::NodeHandle nh);

  /// To be called regularly, by a thread that may wait for the ROS master.
  void update();

 private:
  CommandGate& gate_;
  ros::NodeHandle nh_;
  bool stopped_ = false;
};

}  // namespace perennial
