#!/usr/bin/python3
"""What check_steering prints has the right signs: a camera turned left asks for a turn to the right."""
import random
import subprocess
import unittest

import roslib.packages
import rospy
import rostest
from sensor_msgs.msg import CameraInfo, Image

WIDTH, HEIGHT = 400, 300


def scene():
    """Random rectangles: plenty of corners and blobs."""
    random.seed(1)
    rows = [bytearray([128] * WIDTH) for _ in range(HEIGHT)]
    for _ in range(600):
        left, top = random.randrange(WIDTH - 30), random.randrange(HEIGHT - 30)
        width, height, grey = random.randrange(5, 30), random.randrange(5, 30), random.randrange(256)
        for row in rows[top:top + height]:
            row[left:left + width] = bytes([grey] * width)
    return Image(width=WIDTH, height=HEIGHT, step=WIDTH, encoding="mono8", data=b"".join(bytes(row) for row in rows))


def printed():
    """The first three lines of check_steering."""
    node = subprocess.Popen([roslib.packages.find_node("perennial_nav", "check_steering_node")[0]], stdout=subprocess.PIPE)
    try:
        return [node.stdout.readline().decode() for _ in range(3)]
    finally:
        node.kill()
        node.wait()
        node.stdout.close()


class CheckSteeringTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.publisher = rospy.Publisher("image", Image, queue_size=1, latch=True)
        cls.publisher.publish(scene())

    def test_signs(self):
        lines = printed()
        self.assertIn("gain_per_px counts", lines[0])
        self.assertRegex(lines[1], r"LEFT by arithmetic: displacement -(39|40)\.\d px.*would turn RIGHT, angular.z -0\.0(79|80)")
        self.assertRegex(lines[2], r"RIGHT by arithmetic: displacement \+(39|40)\.\d px.*would turn LEFT, angular.z \+0\.0(79|80)")

    def test_with_a_calibration(self):
        """Of images twice as wide: the turn rate is gain_per_rad (2 by default) times atan(40 / 500)."""
        info = CameraInfo(width=2 * WIDTH, height=2 * HEIGHT, K=[1000.0, 0.0, 400.0, 0.0, 1000.0, 300.0, 0.0, 0.0, 1.0])
        publisher = rospy.Publisher("camera_info", CameraInfo, queue_size=1, latch=True)
        publisher.publish(info)
        lines = printed()
        publisher.unregister()
        self.assertIn("focal length of 500 px by /camera_info", lines[0])
        self.assertRegex(lines[1], r"would turn RIGHT, angular.z -0\.1(5|6)\d")
        self.assertRegex(lines[2], r"would turn LEFT, angular.z \+0\.1(5|6)\d")


if __name__ == "__main__":
    rospy.init_node("check_steering_test")
    rostest.rosrun("perennial_nav", "check_steering_test", CheckSteeringTest)
