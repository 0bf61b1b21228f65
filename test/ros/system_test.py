#!/usr/bin/env python3
"""Nodes that are killed while the robot repeats: it stops, the goal ends with a reason or goes on, and the next one works."""
import os
import shutil
import signal
import sys
import unittest

import rospy
import rostest
from perennial_nav.msg import NavigationState
from std_msgs.msg import Empty
from std_srvs.srv import SetBool, Trigger

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from fake_robot import FakeRobot, wait_until  # noqa: E402
from killing import kill, process_of, wait_for_new  # noqa: E402
from stack import BOTH, LENGTH_M, Stack  # noqa: E402

FOLDER = ""  # of the maps; from the command line


class WatchedRobot(FakeRobot):
    """A fake robot that somebody watches: a heartbeat with every step."""

    def __init__(self):
        super().__init__()
        self.heartbeat = rospy.Publisher("/heartbeat", Empty, queue_size=10)

    def tick(self, seconds):
        super().tick(seconds)
        self.heartbeat.publish()


class Killed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = WatchedRobot()
        cls.stack = Stack(cls.robot)
        wait_until(lambda: cls.robot.heartbeat.get_num_connections() > 0, "the subscriber of the heartbeat")
        result = cls.stack.teach_path("path")
        assert result.success, result.message

    def setUp(self):
        self.begin()

    def tearDown(self):
        self.stack.end(self.stack.repeat)

    def begin(self):
        self.stack.begin_repeat("path")
        self.stack.drive(lambda: self.robot.x > LENGTH_M / 4)
        self.assertFalse(self.stack.done(self.stack.repeat))
        self.assertGreater(self.robot.command().linear.x, 0.1)

    def wait_for_answer(self, node):
        """Until a node that was started anew sees the images; connections to the dead one are counted for a while."""
        stamps = []

        def answers():
            stamps.append(self.robot.step().to_nsec())
            return any(self.robot.has_answer((node, stamp)) for stamp in stamps)

        wait_until(answers, "the new %s to see images" % node)

    def complete(self):
        """Another goal is served from its beginning to its end."""
        self.begin()
        self.stack.drive(lambda: False)
        result = self.stack.result(self.stack.repeat)
        self.assertTrue(result.success, result.reason)

    def test_map_manager(self):
        before = kill("/map_manager")

        def ended():
            self.robot.tick(0.02)
            return self.stack.done(self.stack.repeat)

        wait_until(ended, "the goal to end")
        self.assertIn("map_manager is gone", self.stack.result(self.stack.repeat).reason)
        wait_until(self.robot.stands, "the robot to stop")
        wait_until(lambda: self.stack.states[-1].state == NavigationState.FAILED, "the state 'failed'")
        wait_for_new("/map_manager", before)
        wait_until(self.serves, "the new map_manager")
        self.complete()

    def test_map_manager_that_hangs(self):
        manager = process_of("/map_manager")
        os.kill(manager, signal.SIGSTOP)
        try:
            for _ in range(1000):  # images wait for their local maps now
                if self.failed():
                    break
                self.robot.step(["teach_recorder"])
            wait_until(self.robot.stands, "the robot to stop")
            self.assertIn("no local map", self.stack.states[-1].reason)
            wait_until(lambda: self.stack.done(self.stack.repeat), "the goal to end, though the manager does not answer")
        finally:
            os.kill(manager, signal.SIGCONT)
        self.complete()

    def failed(self):
        return self.stack.states[-1].state == NavigationState.FAILED

    def test_emergency_stop_outlives_the_navigator(self):
        stop = rospy.ServiceProxy("/e_stop", SetBool)
        self.assertTrue(stop(True).success)
        wait_until(self.robot.stands, "the robot to stop")
        wait_until(lambda: self.robot.tick(0.02) or rospy.get_param("/emergency_stopped", False),
                   "the stop to be remembered")  # fmt: skip
        before = kill("/repeat_navigator")
        wait_for_new("/repeat_navigator", before)
        wait_until(lambda: self.robot.heartbeat.get_num_connections() > 0, "the new navigator's safety inputs")
        self.wait_for_answer("repeat_navigator")
        self.stack.repeat.stop_tracking_goal()
        wait_until(lambda: self.stack.repeat.wait_for_server(rospy.Duration(0.01)) or self.stack.tick(), "the action")
        sent = len(self.robot.commands)
        self.stack.begin_repeat("path")
        for _ in range(10):
            self.robot.step(BOTH)
        wait_until(lambda: "there was an emergency stop" in self.stack.states[-1].reason, "the reason")
        self.assertEqual([command for command in self.robot.commands[sent:] if command.linear.x != 0.0], [])
        rospy.wait_for_service("/resume")
        self.assertTrue(rospy.ServiceProxy("/resume", Trigger)().success)
        self.stack.drive(lambda: False)
        result = self.stack.result(self.stack.repeat)
        self.assertTrue(result.success, result.reason)

    @staticmethod
    def serves():
        try:
            rospy.wait_for_service("/begin_traversal", 0.1)
            return True
        except rospy.ROSException:
            return False

    def test_repeat_navigator(self):
        before = kill("/repeat_navigator")
        wait_for_new("/repeat_navigator", before)
        sent = len(self.robot.commands)
        wait_until(lambda: self.robot.heartbeat.get_num_connections() > 0, "the new navigator's safety inputs")
        self.wait_for_answer("repeat_navigator")
        for _ in range(10):
            self.robot.step(["repeat_navigator"])
        moving = [command for command in self.robot.commands[sent:] if command.linear.x != 0.0]
        self.assertEqual(moving, [], "the new navigator must not go on with the old one's goal")
        self.stack.repeat.stop_tracking_goal()
        wait_until(lambda: self.stack.repeat.wait_for_server(rospy.Duration(0.01)) or self.stack.tick(), "the action")
        self.complete()

    def test_teach_recorder(self):
        before = kill("/teach_recorder")
        for _ in range(1000):
            if self.stack.done(self.stack.repeat):
                break
            self.robot.step(["repeat_navigator"])
        self.assertTrue(self.stack.result(self.stack.repeat).success, "it has no part in repeating")
        wait_for_new("/teach_recorder", before)
        self.wait_for_answer("teach_recorder")

    def test_heartbeat_that_stops(self):
        self.robot.heartbeat.unregister()
        self.robot.heartbeat = rospy.Publisher("/silence", Empty, queue_size=10)
        for _ in range(8):
            self.robot.step(BOTH)
        wait_until(self.robot.stands, "the robot to stop")
        wait_until(lambda: "no sign of life" in self.stack.states[-1].reason, "the reason")
        self.robot.heartbeat = rospy.Publisher("/heartbeat", Empty, queue_size=10)
        wait_until(lambda: self.robot.heartbeat.get_num_connections() > 0, "the subscriber of the heartbeat")
        self.stack.drive(lambda: False)
        self.assertTrue(self.stack.result(self.stack.repeat).success)


if __name__ == "__main__":
    FOLDER = rospy.myargv()[1]
    shutil.rmtree(FOLDER, ignore_errors=True)
    rospy.init_node("system_test")
    try:
        rostest.rosrun("perennial_nav", "system", Killed, sys.argv)
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)
