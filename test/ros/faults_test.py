#!/usr/bin/env python3
"""Teach and repeat with the real nodes and a fake robot: cancelling, sensor loss, bad goals, bad input."""
import glob
import math
import os
import shutil
import sys
import unittest

import rospy
import rostest
from perennial_nav.msg import NavigationState, TeachGoal

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from fake_robot import wait_until  # noqa: E402
from stack import BOTH, LENGTH_M, Stack  # noqa: E402

FOLDER = ""  # of the maps; from the command line


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stack = Stack()
        cls.robot = cls.stack.robot
        result = cls.stack.teach_path("path")
        assert result.success, result.message

    def tearDown(self):
        self.stack.end(self.stack.repeat)
        self.stack.end(self.stack.teach)

    def repeated(self, name="path", **goal):
        self.stack.begin_repeat(name, **goal)
        self.stack.drive(lambda: False)
        return self.stack.result(self.stack.repeat)

    def interrupted(self):
        """A repeat of the path, in its middle."""
        self.stack.begin_repeat("path")
        self.stack.drive(lambda: self.robot.x > LENGTH_M / 2)
        self.assertFalse(self.stack.done(self.stack.repeat))
        self.assertGreater(self.robot.command().linear.x, 0.1)

    def assert_stopped(self):
        wait_until(self.robot.stands, "the robot to stop")

    def newest_state(self):
        return self.stack.states[-1]

    # --- the way it should be ---

    def test_teaching_counts_local_maps(self):
        result = self.stack.teach_path("counted")
        self.assertTrue(result.success, result.message)
        self.assertEqual(result.local_maps, 41)
        self.assertAlmostEqual(result.distance_m, LENGTH_M, places=3)
        self.assertTrue(os.path.exists(result.file))

    def test_repeats_the_path(self):
        result = self.repeated()
        self.assertTrue(result.success, result.reason)
        self.assertAlmostEqual(result.distance_m, LENGTH_M, delta=0.01)
        self.assert_stopped()
        registered = [message.has_displacement for message in self.stack.registrations]
        self.assertGreater(sum(registered), 0.9 * len(registered))
        wait_until(lambda: self.newest_state().state == NavigationState.FINISHED, "the state 'finished'")

    def test_turns_back_to_the_path(self):
        self.stack.begin_repeat("path")
        self.robot.left_px = 20  # turned left, the robot must turn right
        self.stack.drive(lambda: self.robot.x > 1.5)
        self.assertLess(self.robot.command().angular.z, -0.01)
        self.assertAlmostEqual(self.stack.registrations[-1].displacement_px, -20.0, delta=1.5)

    def test_starts_in_the_middle(self):
        result = self.repeated(start_distance_m=5.0)
        self.assertTrue(result.success, result.reason)
        self.assertEqual(self.stack.registrations[0].local_map, 25)
        self.assertAlmostEqual(result.distance_m, LENGTH_M - 5.0, delta=0.06)

    def test_traversals_carry_the_overshoot_over(self):
        self.stack.begin_repeat("path", traversals=2)
        self.robot.speed = 0.53  # does not fit the length
        self.robot.loop_m = LENGTH_M  # a closed path: its end is its start
        self.stack.drive(lambda: False)
        result = self.stack.result(self.stack.repeat)
        self.assertTrue(result.success, result.reason)
        self.assertEqual(result.traversals, 2)
        self.assertAlmostEqual(result.distance_m, 2 * LENGTH_M, delta=0.12)
        second = [m for m in self.stack.registrations if m.traversal == self.stack.registrations[-1].traversal]
        self.assertGreater(second[0].distance_m, 0.0)
        self.assertLess(second[0].distance_m, 0.2)

    # --- cancelling and losing sensors ---

    def test_cancelling_stops_the_robot_and_teaches_nothing(self):
        with open(os.path.join(FOLDER, "path.perennial"), "rb") as stored:
            before = stored.read()
        self.interrupted()
        self.stack.repeat.cancel_goal()
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn("cancelled", result.reason)
        self.assert_stopped()
        with open(os.path.join(FOLDER, "path.perennial"), "rb") as stored:
            self.assertEqual(stored.read(), before)

    def test_stops_without_images_and_goes_on_with_them(self):
        self.interrupted()
        self.robot.sends_images = False
        for _ in range(10):
            self.robot.step()
        self.assert_stopped()
        wait_until(lambda: self.newest_state().state == NavigationState.STOPPED, "the state 'stopped'")
        self.assertIn("image", self.newest_state().reason)
        self.robot.sends_images = True
        self.robot.step(BOTH)
        wait_until(lambda: self.newest_state().state == NavigationState.REPEATING, "the state 'repeating'")
        self.assertGreater(self.robot.command().linear.x, 0.1)

    def test_gives_up_without_images(self):
        self.interrupted()
        self.robot.sends_images = False
        for _ in range(150):
            self.robot.step()
            if self.stack.done(self.stack.repeat):
                break
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn("no image", result.reason)

    def test_stops_without_odometry(self):
        self.interrupted()
        self.robot.sends_odometry = False
        for _ in range(10):
            self.robot.step()
        self.assert_stopped()
        wait_until(lambda: "odometry" in self.newest_state().reason, "the reason")

    def test_odometry_that_does_not_move(self):
        self.interrupted()
        self.robot.speed = 0.0
        self.stack.drive(lambda: False)
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn("odometry has not moved", result.reason)
        self.assert_stopped()

    def assert_fails_at_once(self, reason):
        self.robot.step()
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn(reason, result.reason)
        self.assert_stopped()
        wait_until(lambda: self.newest_state().state == NavigationState.FAILED, "the state 'failed'")

    def test_odometry_of_nan(self):
        self.interrupted()
        self.robot.odometry_changes = {"x": math.nan}
        self.assert_fails_at_once("not finite")

    def test_odometry_that_jumps(self):
        self.interrupted()
        self.robot.odometry_changes = {"x": 1000.0}
        self.assert_fails_at_once("jumps")

    def test_odometry_that_jumps_by_less_than_a_metre(self):
        """9 m/s: no such robot drives so fast."""
        self.interrupted()
        self.robot.odometry_changes = {"x": self.robot.x + 0.9}
        self.assert_fails_at_once("jumps")

    def test_image_of_another_size(self):
        self.interrupted()
        self.robot.image_changes = {"width": 160, "height": 100, "step": 160, "data": bytes(160 * 100)}
        self.assert_fails_at_once("160x100")

    def test_image_of_another_encoding(self):
        self.interrupted()
        self.robot.image_changes = {"encoding": "bgr8", "step": 960, "data": bytes(960 * 200)}
        self.assert_fails_at_once("bgr8")

    def test_image_that_is_broken(self):
        self.interrupted()
        self.robot.image_changes = {"data": bytes(17)}
        self.assert_fails_at_once("cannot be read")

    # --- goals that cannot be served ---

    def test_unknown_map(self):
        self.stack.begin_repeat("nowhere")
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn("no map 'nowhere'", result.reason)
        self.assertIn("path", result.reason, "the maps there are must be named")

    def test_map_names_cannot_leave_the_folder(self):
        root = os.path.dirname(FOLDER)

        def files():
            here = [os.path.join(folder, name) for folder, _, names in os.walk(root) for name in names]
            return sorted(here + glob.glob("/etc/passwd.*"))

        before = files()
        for name in ("../evil", os.path.join(root, "evil"), "/etc/passwd", "", ".hidden", "a/b", "evil\n", "x" * 101):
            taught = self.stack.teach_path(name)
            self.assertFalse(taught.success)
            self.assertIn("cannot be the name of a map", taught.message)
            self.stack.begin_repeat(name)
            repeated = self.stack.result(self.stack.repeat)
            self.assertFalse(repeated.success)
            self.assertIn("cannot be the name of a map", repeated.reason)
        self.assertEqual(files(), before)

    def test_start_beyond_the_path(self):
        self.stack.begin_repeat("path", start_distance_m=LENGTH_M + 1.0)
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn("does not lie on the path", result.reason)

    def test_existing_maps_are_not_overwritten(self):
        file = os.path.join(FOLDER, "path.perennial")
        with open(file, "rb") as stored:
            before = stored.read()
        result = self.stack.teach_path("path")
        self.assertFalse(result.success)
        self.assertIn("overwrite", result.message)
        with open(file, "rb") as stored:
            self.assertEqual(stored.read(), before)

    def test_overwriting_on_purpose(self):
        self.assertTrue(self.stack.teach_path("twice").success)
        self.assertTrue(self.stack.teach_path("twice", overwrite=True).success)

    def test_teaching_without_moving_stores_nothing(self):
        self.robot.restart()
        self.stack.start(self.stack.teach, TeachGoal(map_name="standing"))
        self.robot.speed = 0.0
        for _ in range(10):
            self.robot.step(BOTH)
        self.stack.teach.cancel_goal()
        result = self.stack.result(self.stack.teach)
        self.assertFalse(result.success)
        self.assertIn("did not move", result.message)
        self.assertFalse(os.path.exists(os.path.join(FOLDER, "standing.perennial")))

    def assert_teaching_fails(self, reason, spoil):
        """Ends the teaching, although good data might follow, and the map there was stays as it is."""
        file = os.path.join(FOLDER, "path.perennial")
        with open(file, "rb") as stored:
            before = stored.read()
        self.stack.settle()
        self.stack.start(self.stack.teach, TeachGoal(map_name="path", overwrite=True))
        self.robot.speed = 0.5
        for _ in range(10):
            self.robot.step(BOTH)
        spoil()
        result = self.stack.result(self.stack.teach)
        self.assertFalse(result.success)
        self.assertIn(reason, result.message)
        with open(file, "rb") as stored:
            self.assertEqual(stored.read(), before)

    def place_odometry(self, x):
        self.robot.odometry_changes = {"x": x}
        self.robot.step()

    def test_odometry_that_jumps_while_teaching(self):
        self.assert_teaching_fails("odometry jumps", lambda: self.place_odometry(3.5))

    def test_odometry_that_jumps_by_less_than_a_metre_while_teaching(self):
        self.assert_teaching_fails("odometry jumps", lambda: self.place_odometry(self.robot.x + 0.9))

    def test_odometry_of_nan_while_teaching(self):
        self.assert_teaching_fails("not finite", lambda: self.place_odometry(math.nan))

    def freeze(self):
        self.robot.frozen = True
        frozen_at = self.robot.x
        while not self.stack.done(self.stack.teach):
            self.assertLess(self.robot.x, frozen_at + 0.5)
            self.robot.step(["teach_recorder"])

    def test_frozen_camera_while_teaching(self):
        self.assert_teaching_fails("the camera repeats one image", self.freeze)

    def send_old_image(self):
        old = rospy.Time.from_sec(self.robot.time - 1.0)
        self.robot.image_changes = {"header": self.robot.image_message(old).header}
        self.robot.step()

    def test_image_stamps_that_go_back_while_teaching(self):
        self.assert_teaching_fails("stamps of the images go back", self.send_old_image)

    def test_the_same_image_while_standing_is_no_fault(self):
        """As a lossless still is, or a simulator's."""
        self.stack.settle()
        self.stack.start(self.stack.teach, TeachGoal(map_name="paused", overwrite=True))
        for frozen in (True, False):
            self.robot.frozen, self.robot.speed = frozen, 0.0 if frozen else 0.5
            for _ in range(20):
                self.robot.step(BOTH)
        self.stack.teach.cancel_goal()
        result = self.stack.result(self.stack.teach)
        self.assertTrue(result.success, result.message)

    def test_images_of_another_size_while_teaching_are_left_out(self):
        self.stack.settle()
        self.stack.start(self.stack.teach, TeachGoal(map_name="resized"))
        self.robot.speed = 0.5
        self.robot.teleop.publish(self.robot.command())
        for _ in range(10):
            self.robot.step(BOTH)
        self.robot.image_changes = {"width": 160, "height": 100, "step": 160, "data": bytes(160 * 100)}
        for _ in range(5):
            self.robot.step(BOTH)
        self.robot.image_changes = {}
        for _ in range(10):
            self.robot.step(BOTH)
        self.stack.teach.cancel_goal()
        result = self.stack.result(self.stack.teach)
        self.assertTrue(result.success, result.message)
        # Images that fit are at 0 to 0.45 m and at 0.75 to 1.2 m. The one that was due at 0.6 m is taken at 0.75 m.
        self.assertEqual(result.local_maps, 7, "at 0, 0.2, 0.4, 0.75, 0.8, 1.0 and 1.2 m")


if __name__ == "__main__":
    FOLDER = os.path.join(rospy.myargv()[1], "maps")
    shutil.rmtree(os.path.dirname(FOLDER), ignore_errors=True)
    rospy.init_node("faults_test")
    try:
        rostest.rosrun("perennial_nav", "faults", Faults, sys.argv)
    finally:
        shutil.rmtree(os.path.dirname(FOLDER), ignore_errors=True)
