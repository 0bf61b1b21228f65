#!/usr/bin/env python3
"""Driver, robot and camera node are killed while the robot repeats: it stops at once, and the repeat ends with a reason or goes
on, never unguided."""
import os
import shutil
import sys

import rospy
import rostest

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from fake_robot import wait_until  # noqa: E402
from killing import kill, wait_for_new  # noqa: E402
from real_time import RealTimeTest, Robot  # noqa: E402

FOLDER = ""  # of the maps; from the command line


class Killed(RealTimeTest):
    @classmethod
    def setUpClass(cls):
        cls.begin(Robot())

    def test_driver(self):
        """The new one counts the way from 0 again: nobody knows how far the robot rolled meanwhile."""
        self.drive_to(1.0)
        mark = self.robot.mark()
        killed = kill("/cameleon_driver")
        still = self.assert_stops(mark)
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn("started anew", result.reason)
        wait_for_new("/cameleon_driver", killed)
        self.assert_stood(still)
        self.assert_guided()
        self.repeat()
        self.assert_succeeds()

    def test_robot(self):
        """Its odometers start from 0; the driver goes on from where it was."""
        self.drive_to(1.0)
        mark = self.robot.mark()
        killed = kill("/cameleon_simulator")
        wait_for_new("/cameleon_simulator", killed)
        wait_until(lambda: self.robot.newest().simulator_s < self.robot.states[mark - 1].simulator_s, "the robot")
        self.assert_succeeds()
        self.assert_guided()

    def test_camera(self):
        """The new one may be there within the navigator's time-out, or the robot stands meanwhile."""
        self.drive_to(1.0)
        killed = kill("/tara/tara_camera")
        wait_for_new("/tara/tara_camera", killed)
        self.assert_succeeds()
        self.assert_guided()


if __name__ == "__main__":
    FOLDER = rospy.myargv()[1]
    shutil.rmtree(os.path.join(FOLDER, "maps"), ignore_errors=True)
    rospy.init_node("killed_test")
    rostest.rosrun("perennial_nav", "killed", Killed, sys.argv)
