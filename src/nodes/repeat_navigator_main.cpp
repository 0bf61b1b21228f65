#include "perennial/ros/repeat_navigator.h"
#include "ros/node_main.h"

int main(int argc, char** argv) {
  return perennial::runNode<perennial::RepeatNavigator>(argc, argv, "repeat_navigator");
}
