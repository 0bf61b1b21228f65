#pragma once

#include <ros/node_handle.h>
#include <ros/wall_timer.h>

#include <functional>

namespace perennial {

/// Publishes /clock, so that nodes under test measure their time-outs in the simulator's time, and calls the
/// simulator's loop when it is due.
class ClockPublisher {
 public:
  /// `rate`: simulated seconds per second.
  ClockPublisher(ros::NodeHandle nh, double rate, double loop_period_s, std::function<void()> loop);

 private:
  void step();

  ros::Publisher publisher_;
  ros::WallTimer timer_;
  double loop_period_s_;
  std::function<void()> loop_;
  std::uint64_t steps_ = 0;
  double next_loop_s_;
};

}  // namespace perennial
