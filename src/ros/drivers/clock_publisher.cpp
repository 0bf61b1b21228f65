#include "perennial/ros/drivers/clock_publisher.h"

#include <rosgraph_msgs/Clock.h>

#include <utility>

namespace perennial {
namespace {

/// Fine enough for a timer at 20 to 25 Hz.
constexpr double kStep_s = 0.010;
/// A clock must not begin at zero, which stands for "no time yet".
constexpr double kBegin_s = 1000.0;

}  // namespace

ClockPublisher::ClockPublisher(ros::NodeHandle nh, double rate, double loop_period_s,
                               std::function<void()> loop)
    : publisher_(nh.advertise<rosgraph_msgs::Clock>("/clock", 10)),
      loop_period_s_(loop_period_s),
      loop_(std::move(loop)),
      next_loop_s_(loop_period_s) {
  timer_ =
      nh.createWallTimer(ros::WallDuration(kStep_s / rate), [this](const ros::WallTimerEvent&) { step(); });
}

void ClockPublisher::step() {
  ++steps_;
  const double now = static_cast<double>(steps_) * kStep_s;
  rosgraph_msgs::Clock clock;
  clock.clock.fromSec(kBegin_s + now);
  publisher_.publish(clock);
  if (now + 1e-6 >= next_loop_s_) {
    next_loop_s_ += loop_period_s_;
    loop_();
  }
}

}  // namespace perennial
