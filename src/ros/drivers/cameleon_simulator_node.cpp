#include "perennial/ros/drivers/cameleon_simulator.h"
#include "perennial/ros/parameters.h"
#include "ros/node_main.h"

namespace {

struct Node {
  Node(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
      : simulator(nh, private_nh, perennial::loadNode<perennial::CameleonSimulatorSettings>(private_nh, {})) {
  }

  perennial::CameleonSimulator simulator;
};

}  // namespace

int main(int argc, char** argv) { return perennial::runNode<Node>(argc, argv, "cameleon_simulator"); }
