#!/usr/bin/env python3
"""Teach and repeat in the embedded world through the real nodes, with the parts of the demo's mission."""
import importlib.machinery
import importlib.util
import math
import os
import shutil
import sys
import unittest

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from perennial_nav.msg import RepeatGoal

DEMO, FOLDER = "", ""


def load(path):
    loader = importlib.machinery.SourceFileLoader("park_demo", path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("park_demo", loader))
    loader.exec_module(module)
    return module


class Park(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.demo = load(DEMO)
        cls.mission = cls.demo.Mission(FOLDER)
        rospy.wait_for_service("set_park")
        cls.taught = cls.mission.teach()

    def test_comes_back_to_the_path(self):
        finished, truth, states = self.mission.repeat("offset_start", 0.4, 6.0, self.demo.DAY, "matches.png")
        self.assertTrue(finished)
        rows = self.demo.errors(self.taught, truth, states)
        length = self.taught[-1, 3]
        self.assertGreater(max(abs(row[1]) for row in rows), 0.3, "it did start beside the path")
        half = [row[1] for row in rows if row[0] > length / 2]
        rms = math.sqrt(sum(error * error for error in half) / len(half))
        print("cross-track RMS over the second half: %.3f m" % rms)
        self.assertLessEqual(rms, 0.10)
        self.assertTrue(os.path.getsize(os.path.join(FOLDER, "matches.png")) > 10000, "somebody looked at the matches")

    def cancel_in_the_middle(self):
        mission = self.mission
        mission.place(0.0, 0.0, self.demo.DAY, False)
        mission.repeat_client.send_goal(RepeatGoal(map_name="loop", traversals=1))
        mission.wait(lambda: mission.far() or mission.done(mission.repeat_client), "half of the loop")
        self.assertEqual(mission.repeat_client.get_state(), GoalStatus.ACTIVE)
        self.assertGreater(mission.truth[-1][4], 0.5, "it drives")
        mission.repeat_client.cancel_goal()
        mission.wait(lambda: mission.done(mission.repeat_client), "the end of the goal")
        mission.wait(lambda: mission.truth[-1][4] < 0.01, "the robot to stand")
        self.assertFalse(mission.repeat_client.get_result().success)

    def place_along_the_path(self):
        """Where on the path the robot really is."""
        _, x, y, _, _ = self.mission.truth[-1]
        row = min(self.taught, key=lambda row: math.hypot(row[0] - x, row[1] - y))
        return row[3]

    def test_cancelled_in_the_middle_it_stops_and_finds_its_place_again(self):
        mission = self.mission
        self.cancel_in_the_middle()
        here_m = self.place_along_the_path()
        self.assertGreater(here_m, 0.3 * self.taught[-1, 3])
        mission.repeat_client.send_goal(RepeatGoal(map_name="loop", localise=True))
        mission.wait(lambda: mission.done(mission.repeat_client), "the end of the loop")
        result = mission.repeat_client.get_result()
        print("at %.2f m, found at %.2f m with certainty %.2f" % (here_m, result.start_distance_m, result.certainty))
        self.assertTrue(result.success, result.reason)
        self.assertAlmostEqual(result.start_distance_m, here_m, delta=1.0)
        end = self.taught[-1]
        _, x, y, _, _ = mission.truth[-1]
        self.assertLess(math.hypot(x - end[0], y - end[1]), 1.0, "it drove to the end of the loop")

    def test_put_down_in_the_dark_it_refuses(self):
        mission = self.mission
        night = "{date_time: '2026-06-21T23:30:00Z', weather: clear}"
        mission.place(0.0, 0.0, night, False)
        mission.repeat_client.send_goal(RepeatGoal(map_name="loop", localise=True))
        mission.wait(lambda: mission.done(mission.repeat_client), "the refusal")
        result = mission.repeat_client.get_result()
        self.assertFalse(result.success, result.reason)
        self.assertIn("not found", result.reason)
        self.assertLess(max(row[4] for row in mission.truth), 0.01, "it must not move")


if __name__ == "__main__":
    DEMO, FOLDER = rospy.myargv()[1:3]
    shutil.rmtree(FOLDER, ignore_errors=True)
    os.makedirs(FOLDER)
    rospy.init_node("park_test")
    rostest.rosrun("perennial_nav", "park", Park, sys.argv)
