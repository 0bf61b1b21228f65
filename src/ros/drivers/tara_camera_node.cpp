#include <ros/init.h>

#include "perennial/ros/drivers/node_main.h"
#include "perennial/ros/drivers/tara_camera.h"
#include "perennial/ros/parameters.h"

namespace {

/// Plugins of image_transport keep their own parameters below ours.
perennial::Parameters ownParameters(const ros::NodeHandle& private_nh) {
  perennial::Parameters own;
  for (const auto& [key, value] : perennial::readParameters(private_nh)) {
    if (key.find('/') == std::string::npos) {
      own.emplace(key, value);
    }
  }
  return own;
}

void run() {
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  perennial::endSpinningOnSignals();
  perennial::ParameterReader reader(ownParameters(private_nh), private_nh.getNamespace() + "/");
  const auto settings = perennial::TaraCameraSettings::load(reader);
  reader.requireAllUsed();
  const perennial::TaraCamera camera(nh, private_nh, settings);
  ros::spin();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "tara_camera", ros::init_options::NoSigintHandler);
  return perennial::runNode(run);
}
