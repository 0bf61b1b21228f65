#include "perennial/ros/drivers/tara_camera.h"
#include "perennial/ros/parameters.h"
#include "ros/node_main.h"

namespace {

struct Node {
  Node(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
      : camera(nh, private_nh, perennial::loadNode<perennial::TaraCameraSettings>(private_nh, {})) {}

  perennial::TaraCamera camera;
};

}  // namespace

int main(int argc, char** argv) { return perennial::runNode<Node>(argc, argv, "tara_camera"); }
