#!/usr/bin/python3
"""With robot.launch a person drives by joystick while nothing is repeated, within the limits that were given."""
import os
import sys
import unittest

import rosgraph
import rospy
import rostest
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Joy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from waiting import Waiter  # noqa: E402


def nodes_of(topic, state):
    return {node for name, nodes in state if name == topic for node in nodes} - {rospy.get_name()}


class RobotTest(unittest.TestCase):
    def test_a_joystick_drives_through_the_command_gate(self):
        waiter, commands = Waiter(), []

        def on_command(message):
            commands.append(message.linear.x)
            waiter.notify()

        subscriber = rospy.Subscriber("/base/cmd_vel", Twist, on_command, queue_size=100)
        joystick = rospy.Publisher("/joy", Joy, queue_size=1)
        hold = Joy(axes=[0.0, 1.0], buttons=[0, 0, 0, 0, 1])
        timer = rospy.Timer(rospy.Duration(0.05), lambda _: joystick.publish(hold))
        # The joystick asks for 0.3 m/s, robot.yaml allows 0.2.
        waiter.wait_for(lambda: 0.2 in commands, "the robot to drive as fast as it may")
        publishers, listeners, _ = rosgraph.Master(rospy.get_name()).getSystemState()
        self.assertEqual(nodes_of("/base/cmd_vel", publishers), {"/repeat_navigator"})
        self.assertIn("/teach_recorder", nodes_of("/base/cmd_vel", listeners))
        timer.shutdown()
        del commands[:]
        waiter.wait_for(lambda: 0.0 in commands, "the robot to stop when the joystick is silent")
        self.assertLessEqual(max(commands), 0.2)
        subscriber.unregister()


if __name__ == "__main__":
    rospy.init_node("robot_test")
    rostest.rosrun("perennial_nav", "robot", RobotTest, sys.argv)
