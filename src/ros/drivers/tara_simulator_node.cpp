#include <ros/init.h>

#include "perennial/ros/drivers/node_main.h"
#include "perennial/ros/drivers/tara_simulator.h"
#include "perennial/ros/parameters.h"

namespace {

void run() {
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  perennial::endSpinningOnSignals();
  perennial::ParameterReader reader(perennial::readParameters(private_nh), private_nh.getNamespace() + "/");
  const auto settings = perennial::TaraSimulatorSettings::load(reader);
  reader.requireAllUsed();
  const perennial::TaraSimulator simulator(nh, private_nh, settings);
  ros::spin();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "tara_simulator", ros::init_options::NoSigintHandler);
  return perennial::runNode(run);
}
