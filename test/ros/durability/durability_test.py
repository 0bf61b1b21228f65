#!/usr/bin/env python3
"""Maps in hard times, with the real nodes: a second manager, a full disk, a map of an older format."""
import os
import shutil
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from perennial_nav.srv import BeginTraversal, EndTraversal

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from stack import MapContent, Node, Stack, make_format_1, verify, wait_until  # noqa: E402

FOLDER, PRELOAD = "", ""
MIDDLE = 20  # steps


class Durability(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.flag = os.path.join(FOLDER, "full")
        cls.file = os.path.join(FOLDER, "maps", "path.perennial")
        full_disk = {"LD_PRELOAD": os.environ.get("PERENNIAL_PRELOAD_FIRST", "") + PRELOAD, "FULL_DISK": cls.flag}
        cls.second = Node("map_manager_2", {"ROS_NAMESPACE": "/second"},
                          ["_map_folder:=" + os.path.join(FOLDER, "maps"), "_strategy:=latest"])
        cls.stack = Stack([Node("teach_recorder", full_disk), Node("map_manager", full_disk), Node("repeat_navigator")])
        cls.problems = set()
        rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics)
        cls.stack.start()
        assert cls.stack.teach_path("path").success
        assert cls.stack.repeat_path("path").success

    @classmethod
    def tearDownClass(cls):
        cls.second.kill()
        cls.stack.stop()

    @classmethod
    def on_diagnostics(cls, message):
        cls.problems.update(status.message for status in message.status if status.level == DiagnosticStatus.ERROR)

    def tearDown(self):
        self.empty_disk()
        wait_until(lambda: self.stack.tick() and self.stack.is_done(self.stack.repeat), "the end")

    def fill_disk(self, _=None):
        with open(self.flag, "w"):
            pass

    def empty_disk(self):
        if os.path.exists(self.flag):
            os.remove(self.flag)

    def content(self):
        self.assertEqual(verify(self.file), "")
        return MapContent(self.file)

    def test_a_second_manager_of_one_map_is_refused(self):
        self.second.start()
        rospy.wait_for_service("/second/begin_traversal", 60.0)
        begin = rospy.ServiceProxy("/second/begin_traversal", BeginTraversal)
        answers = []
        before = self.content().newest()
        result = self.stack.repeat_path(
            "path", after_step=lambda i: i == MIDDLE and answers.append(begin("path", 0.0, rospy.Time.now())))
        self.assertTrue(result.success, result.reason)
        self.assertEqual(self.content().newest(), before + 1, "the first one is not disturbed")
        self.assertFalse(answers[0].success)
        self.assertIn("another program", answers[0].message)
        answer = begin("path", 0.0, rospy.Time.now())
        self.assertTrue(answer.success, answer.message)
        end = rospy.ServiceProxy("/second/end_traversal", EndTraversal)
        self.assertTrue(end(answer.traversal, 0, False, rospy.Time.now()).success)

    def repeats_without_learning(self, full_from):
        before = self.content()
        if full_from == 0:
            self.fill_disk()
        self.problems.clear()
        result = self.stack.repeat_path("path", traversals=2, after_step=lambda i: i == full_from and self.fill_disk())
        self.assertTrue(result.success, result.reason)
        self.assertEqual(result.traversals, 2)
        wait_until(lambda: self.stack.tick() and any("space" in problem for problem in self.problems), "diagnostics that say it")
        self.empty_disk()
        after = self.content()
        self.assertEqual(after.newest(), before.newest(), "nothing was learned")
        self.assertEqual(after.upto(after.newest()), before.upto(before.newest()), "the map is as it was")
        result = self.stack.repeat_path("path")
        self.assertTrue(result.success, result.reason)
        self.assertEqual(self.content().newest(), before.newest() + 1, "with room again, it learns again")

    def test_the_robot_goes_on_when_the_disk_is_full(self):
        self.repeats_without_learning(full_from=0)

    def test_the_robot_goes_on_when_the_disk_gets_full(self):
        self.repeats_without_learning(full_from=MIDDLE)

    def test_a_map_of_format_1_is_repeated_as_it_is_until_there_is_room_to_migrate_it(self):
        make_format_1(self.file)
        with open(self.file, "rb") as file:
            original = file.read()
        before = self.content()
        self.fill_disk()
        self.problems.clear()
        result = self.stack.repeat_path("path")
        self.assertTrue(result.success, result.reason)
        wait_until(lambda: self.stack.tick() and any("format version 1" in problem and "space" in problem
                                                     for problem in self.problems), "diagnostics that say it")
        with open(self.file, "rb") as file:
            self.assertEqual(file.read(), original)
        self.empty_disk()
        result = self.stack.repeat_path("path")
        self.assertTrue(result.success, result.reason)
        after = self.content()
        self.assertEqual(after.version, 2)
        self.assertEqual(after.newest(), before.newest() + 1)
        self.assertEqual(after.upto(before.newest()), before.upto(before.newest()))
        with open(self.file + ".format1", "rb") as file:
            self.assertEqual(file.read(), original)
        self.assertEqual(sorted(os.listdir(os.path.dirname(self.file))), ["path.perennial", "path.perennial.format1"])
        os.remove(self.file + ".format1")

    def test_teaching_on_a_full_disk_leaves_the_old_map(self):
        before = self.content()
        result = self.stack.teach_path("path", after_step=lambda i: i == MIDDLE and self.fill_disk())
        self.assertFalse(result.success)
        self.assertIn("space", result.message)
        self.empty_disk()
        after = self.content()
        self.assertEqual(after.upto(after.newest()), before.upto(before.newest()))
        self.assertFalse(os.path.exists(self.file + ".partial"))


if __name__ == "__main__":
    FOLDER, PRELOAD = rospy.myargv()[1:3]
    shutil.rmtree(FOLDER, ignore_errors=True)
    os.makedirs(FOLDER)
    rospy.init_node("durability_test")
    try:
        rostest.rosrun("perennial_nav", "durability", Durability, sys.argv)
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)
