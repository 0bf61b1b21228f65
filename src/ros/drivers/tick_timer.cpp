#include "perennial/ros/drivers/tick_timer.h"

#include <ros/time.h>

namespace perennial {

double driverTime() {
  return ros::Time::isSimTime() ? ros::Time::now().toSec() : ros::SteadyTime::now().toSec();
}

TickTimer::TickTimer(ros::NodeHandle nh, double period_s, std::function<void()> tick) {
  if (ros::Time::isSimTime()) {
    simulated_ = nh.createTimer(ros::Duration(period_s), [tick](const ros::TimerEvent&) { tick(); });
  } else {
    steady_ =
        nh.createSteadyTimer(ros::WallDuration(period_s), [tick](const ros::SteadyTimerEvent&) { tick(); });
  }
}

}  // namespace perennial
