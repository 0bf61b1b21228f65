#include <ros/init.h>
#include <ros/time.h>

#include "perennial/ros/drivers/cameleon_driver.h"
#include "perennial/ros/drivers/node_main.h"
#include "perennial/ros/parameters.h"

namespace {

void run() {
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  perennial::endSpinningOnSignals();
  perennial::ParameterReader reader(perennial::readParameters(private_nh), private_nh.getNamespace() + "/");
  const auto settings = perennial::CameleonDriverSettings::load(reader);
  reader.requireAllUsed();
  ros::Time::waitForValid();  // of simulated time, when that is used
  const perennial::CameleonDriver driver(nh, private_nh, settings);
  ros::spin();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "cameleon_driver", ros::init_options::NoSigintHandler);
  return perennial::runNode(run);
}
