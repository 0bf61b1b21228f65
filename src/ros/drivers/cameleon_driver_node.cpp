#include "perennial/ros/drivers/cameleon_driver.h"
#include "perennial/ros/parameters.h"
#include "ros/node_main.h"

namespace {

struct Node {
  Node(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
      : driver(nh, private_nh, perennial::loadNode<perennial::CameleonDriverSettings>(private_nh, {})) {}

  perennial::CameleonDriver driver;
};

}  // namespace

int main(int argc, char** argv) { return perennial::runNode<Node>(argc, argv, "cameleon_driver"); }
