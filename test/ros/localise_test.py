#!/usr/bin/env python3
"""A repeat with `localise`, with the real nodes: the robot finds its place on the path, or refuses and never moves.

PERENNIAL_LOCAL_MAPS=1000 measures how long a view takes that is compared with so many local maps of 500 features.
"""
import math
import os
import re
import shutil
import subprocess
import sys
import unittest
from unittest import mock

import roslib.packages
import rospy
import rostest
from geometry_msgs.msg import Twist
from perennial_nav.msg import NavigationState, RepeatGoal
from rosgraph_msgs.msg import Log
from std_srvs.srv import SetBool, Trigger

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import fake_robot  # noqa: E402
from fake_robot import HEIGHT, WIDTH, FakeRobot, wait_until  # noqa: E402
from killing import process_of  # noqa: E402
from stack import BOTH, LENGTH_M, Stack  # noqa: E402

FOLDER = ""  # of the maps; from the command line
LOCAL_MAPS = int(os.environ.get("PERENNIAL_LOCAL_MAPS", "120"))
INTERVAL_M = 0.2  # of local maps
fake_robot.SCENE_M = 1.0  # every metre looks different


def processor_s():
    """What the two nodes of a repeat have used of the processor, in all their threads."""
    ticks = 0
    for node in ["map_manager", "repeat_navigator"]:
        with open("/proc/%d/stat" % process_of(node)) as stat:
            ticks += sum(int(field) for field in stat.read().rsplit(")", 1)[1].split()[11:13])
    return ticks / os.sysconf("SC_CLK_TCK")


class Wanderer(FakeRobot):
    """A fake robot in a corridor that may repeat itself."""

    corridor_m = math.inf

    def restart(self, x=0.0):
        super().restart(x)
        self.loop_m = self.corridor_m


class Localise(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = Wanderer()
        cls.stack = Stack(cls.robot)
        cls.by_hand = rospy.Publisher("/teleop_vel", Twist, queue_size=10)
        wait_until(lambda: cls.by_hand.get_num_connections() > 0, "the subscriber of commands by hand")
        rospy.wait_for_service("/e_stop")
        cls.stop = rospy.ServiceProxy("/e_stop", SetBool)
        cls.resume = rospy.ServiceProxy("/resume", Trigger)
        result = cls.stack.teach_path("path")
        assert result.success, result.message

    def tearDown(self):
        self.stack.end(self.stack.repeat)
        self.robot.corridor_m = math.inf

    def begin(self, x, name="path"):
        """A robot that was put down at x, and is told to find out where that is."""
        self.stack.settle(x)
        del self.stack.registrations[:], self.stack.states[:]
        goal = RepeatGoal(map_name=name, localise=True, start_distance_m=1000.0)  # which is ignored
        self.stack.start(self.stack.repeat, goal)

    def seen(self, text):
        return any(text in state.reason for state in list(self.stack.states))

    def complete(self):
        self.stack.drive(lambda: False)
        result = self.stack.result(self.stack.repeat)
        self.assertTrue(result.success, result.reason)
        return result

    def assert_refuses(self, x, *reasons):
        """The goal fails for these reasons, and nothing has ever moved the robot."""
        self.stack.drive(lambda: False)
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        for reason in reasons:
            self.assertIn(reason, result.reason)
        self.assertEqual(self.robot.x, x)
        moving = [c for c in self.robot.commands if c.linear.x != 0.0 or c.angular.z != 0.0]
        self.assertEqual(moving, [], "it must not move")
        wait_until(lambda: self.stack.states[-1].state == NavigationState.FAILED, "the state")
        self.assertIn(reasons[0], self.stack.states[-1].reason)
        self.assertEqual(result.certainty, 0.0)

    # --- found ---

    def test_finds_its_place_in_the_middle_and_finishes(self):
        self.begin(5.5)
        self.robot.step(BOTH)
        self.assertTrue(self.robot.stands(), "one image is not enough")
        wait_until(lambda: self.seen("another image has to agree"), "the state that says so")
        self.assertEqual(self.stack.states[-1].state, NavigationState.STARTING)
        result = self.complete()
        self.assertAlmostEqual(result.start_distance_m, 5.5, delta=1.0)
        self.assertGreater(result.certainty, 0.5)
        self.assertIn("found with certainty", result.reason)
        self.assertAlmostEqual(self.stack.registrations[0].distance_m, 5.5, delta=1.0)
        self.assertAlmostEqual(self.robot.x, LENGTH_M, delta=1.0)
        self.assertTrue(self.seen("looking for the place: image 1 of 2"))
        self.assertTrue(self.seen("features agree, certainty"))

    def test_asked_for_from_the_command_line(self):
        self.stack.settle(5.5)
        del self.stack.states[:]
        program = roslib.packages.find_node("perennial_nav", "goal")[0]  # rosrun finds the script's source, too
        goal = subprocess.Popen([program, "repeat", "path", "--localise"],
                                stdout=subprocess.PIPE, universal_newlines=True)  # fmt: skip
        # An image whose odometry came before the goal would wait for the next one, and this robot for the image.
        wait_until(lambda: goal.poll() is not None or self.robot.tick(0.01) or self.stack.states, "the goal")
        wait_until(lambda: goal.poll() is not None or self.robot.step(BOTH) is None, "the end of the path")
        output = goal.communicate()[0]
        self.assertEqual(goal.returncode, 0, output)
        self.assertRegex(output, "from 5.[0-9] m on, found with certainty")

    def test_finds_the_beginning_too(self):
        self.begin(0.3)
        self.assertAlmostEqual(self.complete().start_distance_m, 0.3, delta=1.0)

    def test_emergency_stop_holds_a_robot_that_knows_its_place(self):
        self.stop(True)
        self.begin(3.5)
        for _ in range(6):
            self.robot.step(BOTH)
        wait_until(lambda: len(self.stack.registrations) > 1, "the robot to see the path")
        self.assertTrue(self.seen("emergency stop"))
        self.assertEqual(self.robot.x, 3.5)
        self.stop(False)
        self.assertTrue(self.resume().success)
        self.assertAlmostEqual(self.complete().start_distance_m, 3.5, delta=1.0)

    def test_looks_when_the_person_who_drives_has_let_go(self):
        self.begin(6.7)
        command = Twist()
        command.linear.x = -0.5
        for _ in range(30):
            self.by_hand.publish(command)
            self.robot.step(BOTH)
        here = self.robot.x
        self.assertLess(here, 5.6, "it was driven back")
        wait_until(lambda: self.seen("by hand"), "the state that says so")
        self.assertFalse(self.stack.registrations, "the place was not sought meanwhile")
        self.assertAlmostEqual(self.complete().start_distance_m, here, delta=1.0)

    # --- refused ---

    def test_a_view_of_elsewhere(self):
        self.begin(5000.5)
        self.assert_refuses(5000.5, "not recognised")

    def test_a_covered_camera(self):
        self.begin(5.5)
        self.robot.image_changes = {"data": bytes([40]) * (WIDTH * HEIGHT)}
        self.assert_refuses(5.5, "not recognised")

    def test_two_places_that_look_the_same(self):
        self.robot.corridor_m = LENGTH_M / 2
        self.assertTrue(self.stack.teach_path("twice", overwrite=True).success)
        self.begin(1.5, "twice")
        self.assert_refuses(1.5, "ambiguous")
        places = [float(metres) for metres in re.findall(r"like ([0-9.]+) m", self.stack.result(self.stack.repeat).reason)]
        self.assertEqual(len(places), 2)
        self.assertAlmostEqual(min(places), 1.5, delta=1.0)
        self.assertAlmostEqual(max(places), 5.5, delta=1.0)

    def test_the_ends_of_a_path_that_look_the_same(self):
        self.robot.corridor_m = LENGTH_M - 1.0  # the last metre looks like the first
        self.assertTrue(self.stack.teach_path("ends", overwrite=True).success)
        self.begin(0.5, "ends")
        self.assert_refuses(0.5, "ambiguous", "localisation/loop: true")

    def test_two_images_that_disagree(self):
        self.begin(2.5)
        self.robot.odometry_changes = {"x": 2.5}
        self.robot.step(BOTH)
        self.robot.x = 6.5  # carried away, and the wheels have not turned
        self.assert_refuses(6.5, "two images disagree")

    def test_the_end_of_the_path(self):
        self.begin(LENGTH_M)
        self.assert_refuses(LENGTH_M, "end of the path")

    def test_another_camera(self):
        self.begin(5.5)
        self.robot.image_changes = {"height": HEIGHT // 2, "data": bytes(WIDTH * HEIGHT // 2)}
        self.assert_refuses(5.5, "was taught with")

    def test_cancelled_while_it_looks(self):
        self.begin(5.5)
        self.robot.step()
        self.stack.repeat.cancel_goal()
        result = self.stack.result(self.stack.repeat)
        self.assertIn("cancelled", result.reason)
        self.assertEqual(self.robot.x, 5.5)
        self.assertTrue(self.robot.stands())
        self.begin(5.5)  # and the next goal is served
        self.complete()

    # --- how long it takes ---

    def test_a_long_path(self):
        """Images of the size and features of a usual camera."""
        seconds = []

        def note(message):
            for local_maps, took_s in re.findall(r"compared with (\d+) local maps in ([0-9.]+) s", message.msg):
                seconds.append((local_maps, took_s, processor_s()))

        log = rospy.Subscriber("/rosout", Log, note)
        with mock.patch.multiple(fake_robot, WIDTH=752, HEIGHT=480):
            length_m = (LOCAL_MAPS - 1) * INTERVAL_M
            result = self.stack.teach_path("long", overwrite=True, length_m=length_m, speed=2.0)
            self.assertTrue(result.success, result.message)
            self.assertAlmostEqual(result.local_maps, LOCAL_MAPS, delta=2)
            before = processor_s()
            self.begin(length_m - 2.5, "long")
            result = self.complete()
        self.assertAlmostEqual(result.start_distance_m, length_m - 2.5, delta=1.0)
        wait_until(lambda: len(seconds) == 2, "how long it took")
        first, second = seconds
        print("\na view against %s local maps: %s s and %s s, of the processor %.2f and %.2f s"
              % (first[0], first[1], second[1], first[2] - before, second[2] - first[2]))  # fmt: skip
        log.unregister()


if __name__ == "__main__":
    FOLDER = rospy.myargv()[1]
    shutil.rmtree(FOLDER, ignore_errors=True)
    rospy.init_node("localise_test")
    try:
        rostest.rosrun("perennial_nav", "localise", Localise, sys.argv)
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)
