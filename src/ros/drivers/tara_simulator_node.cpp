#include "perennial/ros/drivers/tara_simulator.h"
#include "perennial/ros/parameters.h"
#include "ros/node_main.h"

namespace {

struct Node {
  Node(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
      : simulator(nh, private_nh, perennial::loadNode<perennial::TaraSimulatorSettings>(private_nh, {})) {}

  perennial::TaraSimulator simulator;
};

}  // namespace

int main(int argc, char** argv) { return perennial::runNode<Node>(argc, argv, "tara_simulator"); }
