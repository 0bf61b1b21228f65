#include <ros/init.h>
#include <ros/time.h>

#include <memory>

#include "perennial/ros/drivers/cameleon_simulator.h"
#include "perennial/ros/drivers/clock_publisher.h"
#include "perennial/ros/drivers/node_main.h"
#include "perennial/ros/drivers/tick_timer.h"
#include "perennial/ros/parameters.h"

namespace {

void run() {
  using perennial::CameleonRobot;
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  perennial::ParameterReader reader(perennial::readParameters(private_nh), private_nh.getNamespace() + "/");
  const auto settings = perennial::CameleonSimulatorSettings::load(reader);
  const bool publish_clock = reader.boolean("publish_clock", false);
  const double clock_rate = reader.real("clock_rate", 1.0, 0.1, 20.0);
  reader.requireAllUsed();

  perennial::CameleonSimulator simulator(nh, private_nh, settings);
  const auto loop = [&simulator] { simulator.loop(); };
  std::unique_ptr<perennial::ClockPublisher> clock;
  std::unique_ptr<perennial::TickTimer> timer;
  if (publish_clock) {
    clock = std::make_unique<perennial::ClockPublisher>(nh, clock_rate, CameleonRobot::kLoopPeriod_s, loop);
  } else {
    timer = std::make_unique<perennial::TickTimer>(nh, CameleonRobot::kLoopPeriod_s, loop);
  }
  ros::spin();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "cameleon_simulator");
  return perennial::runNode(run);
}
