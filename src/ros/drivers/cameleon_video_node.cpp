#include "perennial/ros/drivers/video_stream.h"
#include "perennial/ros/parameters.h"
#include "ros/node_main.h"

namespace {

struct Node {
  Node(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
      : stream(nh, private_nh, perennial::loadNode<perennial::VideoStreamSettings>(private_nh, {})) {}

  perennial::VideoStream stream;
};

}  // namespace

int main(int argc, char** argv) { return perennial::runNode<Node>(argc, argv, "cameleon_video"); }
