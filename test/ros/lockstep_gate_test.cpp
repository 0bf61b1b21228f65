#include "perennial/ros/lockstep_gate.h"

#include <gtest/gtest.h>

namespace perennial {
namespace {

perennial_nav::Processed answer(const std::string& node, double stamp_s) {
  perennial_nav::Processed message;
  message.node = node;
  message.header.stamp = ros::Time(stamp_s);
  return message;
}

geometry_msgs::Twist twist(double forward, double angular) {
  geometry_msgs::Twist command;
  command.linear.x = forward;
  command.angular.z = angular;
  return command;
}

TEST(LockstepGate, isOpenWithoutNodes) {
  LockstepGate gate({});
  gate.expect(ros::Time(1.0));
  EXPECT_TRUE(gate.open());
}

TEST(LockstepGate, waitsForEveryNode) {
  LockstepGate gate({"a", "b"});
  gate.expect(ros::Time(1.0));
  gate.onProcessed(answer("a", 1.0));
  EXPECT_FALSE(gate.open());
  EXPECT_EQ(gate.missing(), std::vector<std::string>{"b"});
  gate.onProcessed(answer("b", 0.9));
  EXPECT_FALSE(gate.open()) << "an answer to another image";
  gate.onProcessed(answer("c", 1.0));
  EXPECT_FALSE(gate.open()) << "an answer of a node that is not in lockstep";
  gate.onProcessed(answer("b", 1.0));
  EXPECT_TRUE(gate.open());
  gate.expect(ros::Time(1.1));
  EXPECT_FALSE(gate.open());
}

TEST(LockstepGate, waitsForTheAnnouncedCommandInEitherOrder) {
  LockstepGate gate({"a"});
  perennial_nav::Processed done = answer("a", 1.0);
  done.has_command = 1;
  done.command = twist(0.5, 0.1);
  gate.expect(ros::Time(1.0));
  gate.onProcessed(done);
  EXPECT_FALSE(gate.open());
  gate.onCommand(twist(0.5, 0.1000001));
  EXPECT_FALSE(gate.open()) << "another command";
  gate.onCommand(done.command);
  EXPECT_TRUE(gate.open());

  done.header.stamp = ros::Time(1.1);
  done.command = twist(0.6, -0.2);
  gate.expect(ros::Time(1.1));
  gate.onCommand(done.command);
  gate.onProcessed(done);
  EXPECT_TRUE(gate.open());
}

TEST(LockstepGate, throughDriversTakesTheirStampsAndNoCommands) {
  LockstepGate gate({"a"}, true);
  gate.expect(ros::Time(1.0));
  perennial_nav::Processed done = answer("a", 1.01);
  done.has_command = 1;
  done.command = twist(0.5, 0.1);
  gate.onProcessed(done);
  EXPECT_TRUE(gate.open()) << "stamped by the camera's driver a little later, and its command goes elsewhere";
  gate.expect(ros::Time(1.2));
  EXPECT_FALSE(gate.open());
  gate.onProcessed(answer("a", 1.0));
  EXPECT_FALSE(gate.open()) << "an answer to the image before";
  gate.onProcessed(answer("a", 1.19));
  EXPECT_TRUE(gate.open());
}

TEST(LockstepGate, doesNotWaitAgainForANodeThatDidNotAnswer) {
  LockstepGate gate({"a", "b"});
  gate.expect(ros::Time(1.0));
  gate.onProcessed(answer("a", 1.0));
  gate.giveUp();
  EXPECT_TRUE(gate.open());
  gate.expect(ros::Time(1.1));
  EXPECT_EQ(gate.missing(), std::vector<std::string>{"a"});
  gate.onProcessed(answer("a", 1.1));
  EXPECT_TRUE(gate.open());
  gate.onProcessed(answer("b", 1.0));  // It lives after all.
  gate.expect(ros::Time(1.2));
  EXPECT_EQ(gate.missing().size(), 2U);
}

}  // namespace
}  // namespace perennial
