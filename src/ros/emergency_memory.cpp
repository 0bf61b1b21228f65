#include "perennial/ros/emergency_memory.h"

#include <utility>

namespace perennial {
namespace {

constexpr char kParameter[] = "emergency_stopped";

}  // namespace

EmergencyMemory::EmergencyMemory(CommandGate& gate, ros::NodeHandle nh) : gate_(gate), nh_(std::move(nh)) {
  if (nh_.getParam(kParameter, stopped_) && stopped_) {
    ROS_WARN("there was an emergency stop when the navigator was ended; call the service resume to go on");
    gate_.latchEmergencyStop();
  }
}

void EmergencyMemory::update() {
  const bool stopped = gate_.emergencyStopped();
  if (stopped != stopped_) {
    stopped_ = stopped;
    nh_.setParam(kParameter, stopped);
  }
}

}  // namespace perennial
