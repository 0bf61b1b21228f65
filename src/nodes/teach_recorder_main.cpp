#include "perennial/ros/teach_recorder.h"
#include "ros/node_main.h"

int main(int argc, char** argv) {
  return perennial::runNode<perennial::TeachRecorder>(argc, argv, "teach_recorder");
}
