#!/usr/bin/env python3
"""The robot with its driver and the master on one machine, the navigator on another: the link between them is cut, and loses
packets. The robot never moves unguided, and goes on afterwards.

In real time, as two machines have it: a simulated clock would stop with the link. What the robot truly does is what its
simulator says, which runs beside the driver.
"""
import os
import shutil
import sys

import rosgraph
import rospkg
import rospy
import rostest
import yaml
from perennial_nav.msg import NavigationState

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from fake_robot import wait_until  # noqa: E402
from machines import COMPUTER, ROBOT, Machines, enter  # noqa: E402
from real_time import RealTimeTest, Robot  # noqa: E402
from skipping import skip  # noqa: E402

FOLDER = ""  # of the maps and logs; from the command line
GIVE_UP_S = 8.0
# TCP tries again after 0.2, 0.6, 1.4, 3.0 and 6.2 s: what a shorter trouble has held back is there before the robot gives up.
CUT_S = 1.0  # after the robot has stopped
LOSS, LOSSY_S = 0.2, 3.0  # share of the packets each way


def log_of(name):
    return os.path.join(FOLDER, name + ".log")


class TwoMachines(RealTimeTest):
    @classmethod
    def setUpClass(cls):
        cls.machines = Machines()
        cls.addClassCleanup(cls.machines.end)
        os.environ["ROS_IP"], os.environ["ROS_MASTER_URI"] = ROBOT, "http://%s:11311" % ROBOT
        cls.machines.start(ROBOT, log_of("master"), "rosmaster", "--core", "-p", "11311")
        wait_until(rosgraph.is_master_online, "the master")
        cls.start_node(ROBOT, "cameleon_simulator")
        cls.start_node(ROBOT, "cameleon_driver", "cameleon", robot_host="127.0.0.1")
        cls.start_node(COMPUTER, "teach_recorder", "teach_recorder", map_folder=FOLDER)
        cls.start_node(COMPUTER, "map_manager", "map_manager", map_folder=FOLDER)
        cls.start_node(COMPUTER, "repeat_navigator", "repeat_navigator", give_up_s=GIVE_UP_S,
                       stall_timeout_s=0.0)  # commands may be lost for long while images come
        rospy.init_node("two_machines_test")
        cls.begin(Robot())

    @classmethod
    def start_node(cls, machine, name, config=None, **parameters):
        loaded = {}
        if config:
            folder = os.path.join(rospkg.RosPack().get_path("perennial_nav"), "config")
            with open(os.path.join(folder, config + ".yaml")) as file:
                loaded = yaml.safe_load(file)
        rosgraph.Master("/two_machines_test").setParam("/" + name, {**loaded, **parameters})
        cls.machines.start(machine, log_of(name), "rosrun", "perennial_nav", name + "_node",
                           "image:=/camera/image_raw", "__name:=" + name)  # fmt: skip

    def tearDown(self):
        self.machines.restore()
        super().tearDown()

    def cut(self, cutting, until):
        """Cuts the link, until something happens after the robot has stopped."""
        mark = self.robot.mark()
        cutting()
        still = self.assert_stops(mark)
        wait_until(lambda: until(still), "the time to restore the link")
        self.assert_stood(still)
        self.machines.restore()

    def lasted(self, mark, seconds):
        states = self.robot.since(mark)
        return bool(states) and states[-1].simulator_s > states[0].simulator_s + seconds

    @staticmethod
    def gave_up(_):
        """Nothing else tells what happens on the other machine meanwhile."""
        with open(log_of("repeat_navigator"), errors="replace") as file:
            return "repeat failed" in file.read()

    def test_link_that_is_cut(self):
        for x_m, cutting in ((0.5, self.machines.unplug), (1.5, self.machines.silence)):
            self.drive_to(x_m)
            self.cut(cutting, lambda still: self.lasted(still, CUT_S))
            wait_until(self.robot.moving, "the robot to go on")
        self.assert_succeeds()
        self.assert_guided()
        stopped = {state.reason for state in self.stack.states if state.state == NavigationState.STOPPED}
        self.assertTrue(any(reason.startswith("no ") for reason in stopped), self.reasons())

    def test_link_that_loses_packets(self):
        self.drive_to(0.5)
        mark = self.robot.mark()
        self.machines.lose(LOSS)
        wait_until(lambda: self.lasted(mark, LOSSY_S), "the link to be bad for a while")
        self.machines.restore()
        self.assert_succeeds()
        self.assert_guided()

    def test_link_that_stays_cut_for_too_long(self):
        self.drive_to(0.5)
        self.cut(self.machines.silence, self.gave_up)
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn("check its topic", result.reason)
        self.assertFalse(self.robot.moving())
        self.assert_guided()


if __name__ == "__main__":
    FOLDER = rospy.myargv()[1]
    problem = enter()
    if problem:
        skip("two_machines", "there can be no two machines here: " + problem)
    else:
        shutil.rmtree(FOLDER, ignore_errors=True)
        os.makedirs(FOLDER)
        rostest.rosrun("perennial_nav", "two_machines", TwoMachines, sys.argv)
