#!/usr/bin/env python3
"""Nodes are killed (SIGKILL) at random moments of teaching and updating: no map is ever harmed.

After every kill the map opens, verifies, and holds what was committed before to the byte, and of the traversal that was
interrupted everything or nothing; the nodes are started again and go on with it.

  rostest --text perennial_nav kill.test kills:=200 [seed:=1]
"""
import os
import random
import shutil
import sys
import threading
import time
import unittest

import rospy
import rostest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from stack import LENGTH_M, SPEED_MPS, MapContent, Node, Stack, verify  # noqa: E402

FOLDER, KILLS, SEED = "", 0, 0
STEPS = int(LENGTH_M / SPEED_MPS / 0.1)
LONGEST_DELAY_STEPS = 6.0


class Killer:
    """Kills a node a random while after a random step; most of them near the end, when maps are stored."""

    def __init__(self, node, chance):
        self.node = node
        self.step = STEPS if chance.random() < 0.6 else chance.randrange(STEPS)
        self.delay_steps = chance.uniform(0.0, LONGEST_DELAY_STEPS)
        self.begin_s = time.monotonic()
        self.timer = None

    def after_step(self, i):
        if i == self.step:
            step_s = (time.monotonic() - self.begin_s) / (i + 1)  # however slow this computer is
            self.timer = threading.Timer(self.delay_steps * step_s, self.node.kill)
            self.timer.start()

    def finish(self):
        """However it went, the node is dead afterwards."""
        if self.timer:
            self.timer.join()
        self.node.kill()


class Kill(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stack = Stack([Node("teach_recorder"), Node("map_manager"), Node("repeat_navigator")])
        cls.stack.start()
        cls.chance = random.Random(SEED)
        cls.file = os.path.join(FOLDER, "path.perennial")
        cls.outcomes = {}

    @classmethod
    def tearDownClass(cls):
        cls.stack.stop()

    def count(self, outcome):
        self.outcomes[outcome] = self.outcomes.get(outcome, 0) + 1

    def content(self):
        """Verified first: opening undoes what the kill interrupted."""
        self.assertEqual(verify(self.file), "")
        content = MapContent(self.file)
        self.assertTrue(content.is_whole())
        return content

    def kill_while_teaching(self):
        before = MapContent(self.file)
        killer = Killer(self.stack.nodes["teach_recorder"], self.chance)
        self.stack.teach_path("path", killer.node, killer.after_step)
        killer.finish()
        after = self.content()
        old = after.upto(after.newest()) == before.upto(before.newest())
        new = after.newest() == 0 and after.places >= LENGTH_M / 0.2
        self.assertTrue(old or new, "neither the old map nor the whole new one")
        self.count("teach_recorder: " + ("the old map" if old else "the new map"))

    def kill_while_updating(self, name):
        before = MapContent(self.file)
        killer = Killer(self.stack.nodes[name], self.chance)
        self.stack.repeat_path("path", killer.node, killer.after_step)
        killer.finish()
        after = self.content()
        self.assertEqual(after.upto(before.newest()), before.upto(before.newest()), "what was committed before")
        self.assertIn(after.newest() - before.newest(), (0, 1))
        self.count(name + (": without the traversal" if after.newest() == before.newest() else ": with the traversal"))

    def test_no_kill_harms_a_map(self):
        self.assertTrue(self.stack.teach_path("path").success)
        for number in range(KILLS):
            victim = self.chance.choice(("teach_recorder", "map_manager", "map_manager", "repeat_navigator"))
            if victim == "teach_recorder":
                self.kill_while_teaching()
            else:
                self.kill_while_updating(victim)
            self.stack.start()
            if number % 10 == 9:
                self.repeats_whole(number + 1)
        self.repeats_whole(KILLS)
        self.assertFalse([name for name in os.listdir(FOLDER) if name not in ("path.perennial", "path.perennial.partial")])

    def repeats_whole(self, number):
        """Undisturbed, the path is repeated and learned from."""
        before = MapContent(self.file).newest()
        result = self.stack.repeat_path("path")
        self.assertTrue(result.success, result.reason)
        self.assertEqual(self.content().newest(), before + 1)
        print("%d kills: %s" % (number, ", ".join("%s %d times" % item for item in sorted(self.outcomes.items()))), flush=True)


if __name__ == "__main__":
    FOLDER, KILLS, SEED = rospy.myargv()[1], int(rospy.myargv()[2]), int(rospy.myargv()[3])
    shutil.rmtree(FOLDER, ignore_errors=True)
    rospy.init_node("kill_test")
    try:
        rostest.rosrun("perennial_nav", "kill", Kill, sys.argv)
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)
