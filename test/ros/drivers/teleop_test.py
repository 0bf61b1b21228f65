#!/usr/bin/python3
"""Somebody at a terminal, and somebody with a joystick, drive the simulated robot through its driver."""
import os
import pty
import signal
import subprocess
import sys
import unittest

import roslib.packages
import rospy
import rostest
from sensor_msgs.msg import Joy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from robot_bench import RobotBench  # noqa: E402

KEY_TIMEOUT_S = 0.6
REACTION_S = 0.4


class TeleopTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bench = RobotBench("unused")
        cls.terminal, inside = pty.openpty()
        cls.teleop = subprocess.Popen([roslib.packages.find_node("perennial_nav", "teleop_node")[0]], stdin=inside)
        cls.held = None
        cls.joystick = rospy.Publisher("joy", Joy, queue_size=1)
        cls.joy_message = None
        cls.bench.subscriber.impl.add_callback(cls.hold, None)

    @classmethod
    def tearDownClass(cls):
        cls.teleop.send_signal(signal.SIGINT)
        cls.teleop.wait(20.0)

    @classmethod
    def hold(cls, _):
        """Once per loop of the simulator, as a keyboard repeats a key that is held."""
        if cls.held is not None:
            os.write(cls.terminal, cls.held)
        if cls.joy_message is not None:
            cls.joystick.publish(cls.joy_message)

    def tearDown(self):
        type(self).held = None
        type(self).joy_message = None
        self.bench.wait_until_still()

    def test_drives_while_a_key_is_held(self):
        type(self).held = b"u"
        self.bench.wait_for(lambda: self.bench.states and self.bench.states[-1][1:3] == (0.3, 0.4), "forward to the left")
        type(self).held = None
        released = self.bench.now()
        self.bench.wait_until_still()
        self.assertLess(self.bench.first_still_after(released) - released, KEY_TIMEOUT_S + REACTION_S)

    def test_stop_key_stops_at_once(self):
        type(self).held = b"i"
        self.bench.wait_for(lambda: self.bench.states and self.bench.states[-1][1] == 0.3, "forward")
        type(self).held = b"k"
        pressed = self.bench.now()
        self.bench.wait_until_still()
        self.assertLess(self.bench.first_still_after(pressed) - pressed, REACTION_S + 0.15)  # and 0.15 s of braking

    def test_joystick_needs_its_button(self):
        type(self).joy_message = Joy(axes=[0.0, 1.0], buttons=[0, 0, 0, 0, 0])
        self.bench.wait_loops(15)
        self.assertFalse(self.bench.is_moving())
        type(self).joy_message = Joy(axes=[0.0, 1.0], buttons=[0, 0, 0, 0, 1])
        self.bench.wait_for(lambda: self.bench.states[-1][1] == 0.3, "forward")
        type(self).joy_message = Joy(axes=[0.0, 1.0], buttons=[0, 0, 0, 0, 0])
        self.bench.wait_until_still()


if __name__ == "__main__":
    rospy.init_node("teleop_driving")
    rostest.rosrun("perennial_nav", "teleop_driving", TeleopTest)
