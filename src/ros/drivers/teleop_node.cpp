#include <geometry_msgs/Twist.h>
#include <sensor_msgs/Joy.h>

#include <cstdio>

#include "perennial/core/drivers/teleop.h"
#include "perennial/ros/drivers/keyboard.h"
#include "perennial/ros/drivers/tick_timer.h"
#include "perennial/ros/parameters.h"
#include "ros/node_main.h"

namespace {

constexpr double kPeriod_s = 0.05;
constexpr const char* kHelp =
    "Hold a key to drive, let go to stop.\n"
    "  u i o   forward, to the left or right      q z  faster, slower\n"
    "  j k l   turn left, stop, turn right        r f  flippers up, down\n"
    "  m , .   backward, to the left or right     Ctrl-C ends\n";

/// Publishes cmd_vel while somebody holds something, one zero when they let go, and then leaves the topic to
/// others.
struct Node {
  Node(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
      : teleop(perennial::loadNode<perennial::TeleopSettings>(private_nh, {})),
        publisher(nh.advertise<geometry_msgs::Twist>("cmd_vel", 1)),
        joy(nh.subscribe("joy", 1, &Node::onJoy, this)),
        timer(nh, kPeriod_s, [this] { tick(); }) {
    std::puts(keyboard.isThere() ? kHelp
                                 : "There is no terminal: only sensor_msgs/Joy on the topic joy drives.");
    std::fflush(stdout);
  }
  ~Node() { publish(perennial::Velocity()); }

  void onJoy(const sensor_msgs::Joy& message) {
    teleop.joy(message.axes, message.buttons, perennial::driverTime());
  }

  void tick() {
    for (const char key : keyboard.read()) {
      teleop.key(key, perennial::driverTime());
    }
    const auto velocity = teleop.velocity(perennial::driverTime());
    if (velocity || driving) {
      publish(velocity.value_or(perennial::Velocity()));
    }
    driving = velocity.has_value();
  }

  void publish(const perennial::Velocity& velocity) {
    geometry_msgs::Twist twist;
    twist.linear.x = velocity.forward;
    twist.angular.z = velocity.angular;
    twist.angular.y = velocity.flipper;
    publisher.publish(twist);
  }

  perennial::Keyboard keyboard;
  perennial::Teleop teleop;
  bool driving = false;
  ros::Publisher publisher;
  ros::Subscriber joy;
  perennial::TickTimer timer;
};

}  // namespace

int main(int argc, char** argv) { return perennial::runNode<Node>(argc, argv, "teleop"); }
