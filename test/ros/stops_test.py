#!/usr/bin/env python3
"""Everything that stops a robot which repeats a path, each with the real nodes and a fake robot."""
import math
import os
import shutil
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Twist
from perennial_nav.msg import NavigationState, RepeatGoal
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import Joy, LaserScan, Range
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, Trigger

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from fake_robot import HEIGHT, WIDTH, FakeRobot, wait_until  # noqa: E402
from stack import BOTH, LENGTH_M, Stack  # noqa: E402

FOLDER = ""  # of the maps; from the command line
LIMIT_MPS, ACCELERATION_MPS2, BRAKING_MPS2 = 1.5, 2.0, 4.0  # as in repeat_navigator.yaml
TURN_LIMIT_RADPS, TURN_ACCELERATION_RADPS2 = 1.5, 5.0
STEP_S = 0.05  # between commands by hand: as in command_gate.cpp


class GuardedRobot(FakeRobot):
    """A fake robot with a person at a joystick and three sensors for obstacles, all content."""

    def __init__(self):
        super().__init__()
        self.publishers = {
            "joy": rospy.Publisher("/joy", Joy, queue_size=10),
            "range": rospy.Publisher("/obstacle_range", Range, queue_size=10),
            "scan": rospy.Publisher("/obstacle_scan", LaserScan, queue_size=10),
            "flag": rospy.Publisher("/obstacle", Bool, queue_size=10),
        }
        self.calm()

    def calm(self):
        self.wall_x = None  # a wall at this place, for the range finder
        self.silent = set()  # names of what says nothing
        self.late = {}  # seconds by name: how old what it says is
        self.held, self.range_m, self.scan_m, self.flag = True, 5.0, 5.0, False

    def restart(self, x=0.0):
        super().restart(x)
        self.calm()

    def tick(self, seconds):
        super().tick(seconds)
        range_m = self.range_m if self.wall_x is None else max(0.0, min(5.0, self.wall_x - self.x))
        messages = {
            "joy": Joy(buttons=[0, 0, int(self.held)]),
            "range": Range(min_range=0.02, max_range=6.0, range=range_m),
            "scan": LaserScan(angle_min=-0.2, angle_increment=0.1, range_max=8.0, ranges=[self.scan_m] * 5),
            "flag": Bool(self.flag),
        }
        for name, message in messages.items():
            if name in self.late:
                message.header.stamp = rospy.Time.from_sec(self.time - self.late[name])
            if name not in self.silent:
                self.publishers[name].publish(message)


class Stops(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = GuardedRobot()
        cls.stack = Stack(cls.robot)
        for publisher in cls.robot.publishers.values():
            wait_until(lambda p=publisher: p.get_num_connections() > 0, "the navigator's safety inputs")
        cls.stop_topic = rospy.Publisher("/e_stop", Bool, queue_size=1, latch=True)
        cls.by_hand = rospy.Publisher("/teleop_vel", Twist, queue_size=10)
        wait_until(lambda: cls.stop_topic.get_num_connections() > 0, "the emergency stop's subscriber")
        wait_until(lambda: cls.by_hand.get_num_connections() > 0, "the subscriber of commands by hand")
        cls.lines = []
        rospy.Subscriber("/rosout", Log, cls.on_log, queue_size=1000)
        rospy.wait_for_service("/e_stop")
        cls.stop_service = rospy.ServiceProxy("/e_stop", SetBool)
        cls.resume = rospy.ServiceProxy("/resume", Trigger)
        result = cls.stack.teach_path("path")
        assert result.success, result.message

    @classmethod
    def on_log(cls, message):
        if message.name in ("/repeat_navigator", "/map_manager") and message.level >= Log.INFO:
            cls.lines.append(message.msg)

    def setUp(self):
        """A repeat of the path, in its middle."""
        self.stack.begin_repeat("path")
        self.stack.drive(lambda: self.robot.x > LENGTH_M / 4)
        self.assertFalse(self.stack.done(self.stack.repeat))
        self.assertGreater(self.robot.command().linear.x, 0.1)
        self.assert_state(NavigationState.REPEATING, "by sight")

    def tearDown(self):
        self.stack.end(self.stack.repeat)

    def steps(self, number):
        for _ in range(number):
            if not self.stack.done(self.stack.repeat):
                self.robot.step(BOTH)

    def assert_state(self, state, reason):
        """Time goes on meanwhile: what watches the robot lives by it."""
        for _ in range(10):
            newest = self.stack.states[-1]
            if newest.state == state and reason in newest.reason:
                return
            self.robot.step(BOTH if self.robot.sends_images and not self.robot.image_changes else None)
        self.fail("not '%s' because of '%s', but '%s' because of '%s'" % (state, reason, newest.state, newest.reason))

    def assert_stands(self, reason, state=NavigationState.STOPPED):
        wait_until(self.robot.stands, "the robot to stop because of " + reason)
        self.assert_state(state, reason)
        self.steps(3)
        self.assertTrue(self.robot.stands(), "it must go on standing")
        self.assertFalse(self.stack.done(self.stack.repeat), "the goal waits")

    def assert_goes_on(self, steps=1):
        self.steps(steps)
        self.assert_state(NavigationState.REPEATING, "by sight")
        self.steps(2)
        self.assertGreater(self.robot.command().linear.x, 0.1)

    def assert_fails(self, reason):
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn(reason, result.reason)
        wait_until(self.robot.stands, "the robot to stop")
        self.assert_state(NavigationState.FAILED, reason)

    # --- people ---

    def release(self):
        self.steps(3)
        self.assertTrue(self.robot.stands(), "releasing must not start the robot")
        self.assert_state(NavigationState.STOPPED, "resume")
        self.assertTrue(self.resume().success)
        self.assert_goes_on()

    def test_emergency_stop_by_topic(self):
        self.stop_topic.publish(True)
        wait_until(self.robot.stands, "the robot to stop at once, without any time going by")
        self.assert_stands("emergency stop")
        self.assertFalse(self.resume().success, "still engaged")
        self.stop_topic.publish(False)
        self.release()

    def test_emergency_stop_by_service(self):
        self.assertTrue(self.stop_service(True).success)
        wait_until(self.robot.stands, "the robot to stop at once, without any time going by")
        self.assert_stands("emergency stop")
        self.assertTrue(self.stop_service(False).success)
        self.release()

    def test_dead_man_lets_go(self):
        self.robot.held = False
        self.robot.tick(0.0)
        self.assert_stands("not held")
        self.robot.held = True
        self.assert_goes_on(2)

    def test_dead_man_is_silent(self):
        self.robot.silent = {"joy"}
        self.steps(7)
        self.assert_stands("no sign of life")
        self.robot.silent = set()
        self.assert_goes_on(2)

    def drive_by_hand(self, forward, steps, turn=0.0):
        command = Twist()
        command.linear.x, command.angular.z = forward, turn
        for _ in range(steps):
            self.by_hand.publish(command)
            self.robot.step(BOTH)

    def test_a_person_takes_over_and_lets_go(self):
        self.drive_by_hand(-0.3, 1)
        self.assert_state(NavigationState.STOPPED, "by hand")
        self.drive_by_hand(-0.3, 15)
        self.assertAlmostEqual(self.robot.command().linear.x, -0.3, places=6)
        self.steps(5)
        self.assert_stands("by hand until")
        self.assert_goes_on(10)

    def test_a_person_backs_the_robot_far(self):
        """Beyond the local maps that are kept: 2 m."""
        self.stack.drive(lambda: self.robot.x > 0.75 * LENGTH_M)
        begun_at = self.robot.x
        self.drive_by_hand(-0.5, 80)
        self.assertLess(self.robot.x, begun_at - 3.0)
        self.assert_goes_on(12)
        self.assertAlmostEqual(self.stack.states[-1].distance_m, self.robot.x, delta=0.3)

    def test_another_program_commands_the_robot(self):
        command = Twist()
        command.linear.x = 0.2
        self.robot.teleop.publish(command)
        self.assert_state(NavigationState.STOPPED, "commands the robot, too")
        self.steps(2)
        self.assert_stands(rospy.get_name())
        self.assert_goes_on(12)

    # --- obstacles ---

    def test_range_finder_slows_then_holds(self):
        self.robot.range_m = 1.0
        self.steps(5)
        self.assertAlmostEqual(self.robot.command().linear.x, 0.3, delta=0.02)  # 0.2 + 0.8 / 2 of 0.5 m/s
        self.robot.range_m = 0.3
        self.steps(3)
        self.assert_stands("in the way, 0.3 m", NavigationState.HOLDING)
        self.robot.range_m = 5.0
        self.assert_goes_on(2)

    def test_a_wall_on_a_slow_path_holds(self):
        """The robot comes near it slower and slower, and is held at last: it is not taken for one that is blocked."""
        self.stack.end(self.stack.repeat)
        result = self.stack.teach_path("slow", overwrite=True, length_m=2.5, speed=0.3)
        self.assertTrue(result.success, result.message)
        self.stack.begin_repeat("slow")
        self.robot.wall_x = 1.8
        self.stack.drive(lambda: self.stack.states[-1].state == NavigationState.HOLDING)
        self.assert_stands("in the way, 0.5 m", NavigationState.HOLDING)
        self.assertAlmostEqual(self.robot.x, 1.3, delta=0.1)
        self.robot.wall_x = None
        self.assert_goes_on(2)
        self.stack.drive(lambda: False)
        result = self.stack.result(self.stack.repeat)
        self.assertTrue(result.success, result.reason)

    def test_laser_scanner_holds(self):
        self.robot.scan_m = 0.4
        self.steps(3)
        self.assert_stands("in the way, 0.4 m", NavigationState.HOLDING)
        self.robot.scan_m = 5.0
        self.assert_goes_on(2)

    def test_obstacle_detector_holds(self):
        self.robot.flag = True
        self.steps(3)
        self.assert_stands("in the way", NavigationState.HOLDING)
        self.robot.flag = False
        self.assert_goes_on(2)

    def test_an_obstacle_that_stays_ends_the_goal(self):
        self.robot.flag = True
        self.steps(60)
        self.assert_fails("nothing changed")

    def test_silent_sensors_stop(self):
        for name, reason in (("range", "range finder"), ("scan", "laser scanner"), ("flag", "obstacle detector")):
            self.robot.silent = {name}
            self.steps(7)
            self.assert_stands(reason + " is silent")
            self.robot.silent = set()
            self.assert_goes_on(2)

    def test_late_messages_are_no_news(self):
        """As after a link that was cut: everything comes, but long after it was said. So do clocks that are wrong."""
        reasons = (("range", "range finder is silent"), ("scan", "laser scanner is silent"), ("joy", "no sign of life"))
        for name, reason in reasons:
            for seconds in (2.0, -3600.0):
                self.robot.late = {name: 0.1}
                self.assert_goes_on(2)
                self.robot.late = {name: seconds}
                self.steps(2)
                self.assert_stands(reason)
            self.robot.late = {}
            self.assert_goes_on(2)

    def test_sensors_that_do_not_know_stop(self):
        self.robot.range_m = math.nan
        self.steps(2)
        self.assert_stands("range finder does not know")
        self.robot.range_m = 5.0
        self.assert_goes_on(2)
        for reading in (math.nan, 0.0):
            self.robot.scan_m = reading
            self.steps(2)
            self.assert_stands("laser scanner does not know")
            self.robot.scan_m = 5.0
            self.assert_goes_on(2)

    # --- the camera and its path ---

    def step_blind(self, level):
        """A wall of one grey in front of the camera, never quite the same."""
        self.robot.image_changes = {"data": bytes([50 + level % 100]) * (WIDTH * HEIGHT)}
        self.robot.step(BOTH)

    def test_blind_it_slows_holds_and_goes_on_when_it_sees(self):
        lost_at = self.robot.x
        states, speeds = [], []
        for level in range(60):
            self.step_blind(level)
            states.append(self.stack.states[-1].state)
            if states[-1] == NavigationState.DEGRADED and len(states) > 5:
                speeds.append(self.robot.command().linear.x)
            if states[-1] == NavigationState.HOLDING:
                break
        for speed in speeds[:-1]:  # with the last one it may hold already, and say so next
            self.assertAlmostEqual(speed, 0.25, delta=0.02)
        self.assertIn(NavigationState.DEGRADED, states)
        self.assert_state(NavigationState.HOLDING, "not recognised for 1.0 m")
        self.assertAlmostEqual(self.robot.x - lost_at, 1.0, delta=0.15)
        self.robot.image_changes = {}
        self.assert_goes_on()

    def test_blind_for_too_long_it_gives_up(self):
        for level in range(200):
            self.step_blind(level)
            if self.stack.done(self.stack.repeat):
                break
        self.assert_fails("not recognised")

    def begin_unseeing(self, x):
        """A goal for a robot that does not recognise the path where it stands."""
        self.stack.end(self.stack.repeat)
        self.stack.settle(x)
        self.stack.start(self.stack.repeat, RepeatGoal(map_name="path"))

    def test_started_elsewhere_it_does_not_move_and_gives_up(self):
        self.begin_unseeing(5000.5)
        self.steps(10)
        self.assert_stands("not recognised here", NavigationState.STARTING)
        self.steps(60)
        self.assert_fails("not recognised here")
        self.assertEqual(self.robot.x, 5000.5)

    def test_started_with_a_covered_camera_it_goes_on_when_it_sees(self):
        self.begin_unseeing(0.0)
        for level in range(20):
            self.step_blind(level)
        self.assertEqual(self.robot.x, 0.0)
        self.assert_state(NavigationState.STARTING, "not recognised here")
        self.robot.image_changes = {}
        self.assert_goes_on(4)

    def lines_of(self, traversals, after_step=lambda i: None):
        """Drives so many traversals; returns how many lines the nodes log meanwhile, and what the states were."""
        self.stack.end(self.stack.repeat)
        self.stack.begin_repeat("path", traversals=traversals)
        self.robot.loop_m = LENGTH_M
        del self.lines[:]
        states = []
        for i in range(1000 * traversals):
            if self.stack.done(self.stack.repeat):
                break
            self.robot.step(BOTH)
            after_step(i)
            states.append(self.stack.states[-1].state)
        result = self.stack.result(self.stack.repeat)
        self.assertTrue(result.success, result.reason)
        done = "traversal %d of 'path' done" % traversals
        wait_until(lambda: any(done in line for line in self.lines), "the log of the last traversal")
        return list(self.lines), states

    def test_the_log_grows_with_traversals_not_with_images(self):
        def most(traversals):  # goal and result; of each traversal its end and three times two states
            return 2 + 7 * traversals

        once, _ = self.lines_of(1)
        self.assertLessEqual(len(once), most(1), once)
        thrice, _ = self.lines_of(3)
        self.assertLessEqual(len(thrice), most(3), thrice)

        def cover(i):
            self.robot.image_changes = {} if i % 5 else {"data": bytes([50 + i % 100]) * (WIDTH * HEIGHT)}

        lines, states = self.lines_of(2, cover)
        changes = sum(a != b for a, b in zip(states, states[1:]))
        self.assertGreater(changes, 60, "seen and not seen in turns")
        self.assertLessEqual(len(lines), most(2), lines)

    def test_frozen_camera(self):
        frozen_at = self.robot.x
        self.robot.frozen = True
        self.steps(8)  # of 0.05 m
        self.assert_stands("frozen")
        self.assertLess(self.robot.x, frozen_at + 0.35, "long before frozen_images have come")
        self.robot.frozen = False
        self.assert_goes_on()

    def fall_behind(self):
        """As when a link or a computer was held up for two seconds: what goes on coming is old."""
        self.robot.time += 2.0
        self.robot.step()
        wait_until(self.robot.stands, "the robot to stop at once")

    def test_images_that_come_late(self):
        self.robot.image_late_s = 2.0
        self.fall_behind()
        self.assert_stands("no fresh image")
        self.steps(10)
        self.assert_stands("no fresh image")
        self.robot.image_late_s = 0.0
        self.assert_goes_on(2)

    def test_odometry_that_comes_late(self):
        self.robot.odometry_late_s = 2.0
        self.fall_behind()
        self.assert_stands("no odometry")
        self.steps(10)
        self.assert_stands("no odometry")
        self.robot.odometry_late_s = 0.0
        self.assert_goes_on(2)

    def test_image_stamps_that_go_back(self):
        self.robot.image_changes = {"header": self.header(-1.0)}
        self.robot.step()
        self.assert_state(NavigationState.STOPPED, "stamps of the images go back")
        wait_until(self.robot.stands, "the robot to stop")
        self.robot.image_changes = {}
        self.assert_goes_on()

    def header(self, seconds):
        message = self.robot.image_message(rospy.Time.from_sec(self.robot.time + seconds))
        return message.header

    def test_odometry_stamps_that_go_back(self):
        message = self.robot.odometry_message(rospy.Time.from_sec(self.robot.time - 1.0), 0.5)
        self.robot.odometry.publish(message)
        self.assert_fails("goes back in time")

    def test_time_that_goes_back(self):
        self.robot.sends_images = self.robot.sends_odometry = False
        self.robot.time -= 5.0
        for _ in range(10):
            self.robot.step()
        self.robot.time += 10.0  # for those that remember
        self.assert_fails("time went back")

    def test_time_that_jumps_forward(self):
        self.robot.sends_images = self.robot.sends_odometry = False
        self.robot.time += 1000.0
        self.robot.step()
        self.assert_state(NavigationState.STOPPED, "no ")
        wait_until(self.robot.stands, "the robot to stop")
        self.robot.sends_images = self.robot.sends_odometry = True
        self.assert_goes_on(2)

    # --- limits, and what others see ---

    def test_limits_hold_whatever_is_asked_for(self):
        with self.robot.lock:
            first = len(self.robot.commands)
        for wanted in (100.0, -100.0):
            self.drive_by_hand(wanted, 20, turn=wanted)
        with self.robot.lock:
            commands = self.robot.commands[first:]
        speeds = [command.linear.x for command in commands]
        turns = [command.angular.z for command in commands]
        self.assertGreater(max(speeds), 0.9 * LIMIT_MPS, "it did drive fast")
        self.assertLess(min(speeds), -0.3 * LIMIT_MPS, "and back")
        self.assertGreater(max(turns), 0.9 * TURN_LIMIT_RADPS)
        self.assertLess(min(turns), -0.9 * TURN_LIMIT_RADPS)
        self.assertLessEqual(max(map(abs, speeds)), LIMIT_MPS + 1e-9)
        self.assertLessEqual(max(map(abs, turns)), TURN_LIMIT_RADPS + 1e-9)
        changes = [(before, after - before) for before, after in zip(speeds, speeds[1:]) if after != 0.0]
        faster = [abs(change) for before, change in changes if before * change >= 0.0]
        slower = [abs(change) for before, change in changes if before * change < 0.0]
        self.assertLessEqual(max(faster), ACCELERATION_MPS2 * STEP_S + 1e-9)
        self.assertGreater(len(slower), 3, "it brakes, and does not stop at once")
        self.assertLessEqual(max(slower), BRAKING_MPS2 * STEP_S + 1e-9)
        turning = [abs(after - before) for before, after in zip(turns, turns[1:]) if after != 0.0]
        self.assertLessEqual(max(turning), TURN_ACCELERATION_RADPS2 * STEP_S + 1e-9)

    def test_diagnostics_tell_the_state_and_why(self):
        seen = []
        subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, seen.append, queue_size=100)
        wait_until(lambda: subscriber.get_num_connections() >= 3, "diagnostics")
        self.stop_topic.publish(True)
        self.assert_stands("emergency stop")

        def told():
            self.robot.step(BOTH)
            texts = [status.message for array in seen for status in array.status]
            return any("stopped: the emergency stop is engaged" in text for text in texts)

        wait_until(told, "the reason in diagnostics")
        subscriber.unregister()
        self.stop_topic.publish(False)
        self.release()


if __name__ == "__main__":
    FOLDER = rospy.myargv()[1]
    shutil.rmtree(FOLDER, ignore_errors=True)
    rospy.init_node("stops_test")
    try:
        rostest.rosrun("perennial_nav", "stops", Stops, sys.argv)
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)
