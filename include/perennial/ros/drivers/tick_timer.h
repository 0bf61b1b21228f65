#pragma once

#include <ros/node_handle.h>
#include <ros/steady_timer.h>
#include <ros/timer.h>

#include <functional>

namespace perennial {

/// Time as a driver measures its time-outs, s: the steady clock, which nobody puts forward or back, or the
/// simulation's clock when there is one.
double driverTime();

/// Calls a function at a fixed rate of driverTime().
class TickTimer {
 public:
  TickTimer(ros::NodeHandle nh, double period_s, std::function<void()> tick);

 private:
  ros::SteadyTimer steady_;
  ros::Timer simulated_;
};

}  // namespace perennial
