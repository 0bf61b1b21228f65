#!/usr/bin/python3
"""What check_steering prints has the right signs: a camera turned left asks for a turn to the right."""
import random
import subprocess
import unittest

import roslib.packages
import rospy
import rostest
from sensor_msgs.msg import Image

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


class CheckSteeringTest(unittest.TestCase):
    def test_signs(self):
        image = scene()
        publisher = rospy.Publisher("image", Image, queue_size=1, latch=True)
        publisher.publish(image)
        node = subprocess.Popen([roslib.packages.find_node("perennial_nav", "check_steering_node")[0]],
                                stdout=subprocess.PIPE)
        try:
            lines = [node.stdout.readline().decode() for _ in range(3)]
        finally:
            node.kill()
            node.wait()
        self.assertRegex(lines[1], r"LEFT by arithmetic: displacement -(39|40)\.\d px.*would turn RIGHT")
        self.assertRegex(lines[2], r"RIGHT by arithmetic: displacement \+(39|40)\.\d px.*would turn LEFT")


if __name__ == "__main__":
    rospy.init_node("check_steering_test")
    rostest.rosrun("perennial_nav", "check_steering_test", CheckSteeringTest)
