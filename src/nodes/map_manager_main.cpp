#include "perennial/ros/map_manager_node.h"
#include "ros/node_main.h"

int main(int argc, char** argv) {
  return perennial::runNode<perennial::MapManagerNode>(argc, argv, "map_manager");
}
