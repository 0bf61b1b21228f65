#!/usr/bin/python3
"""The video node against a real RTSP server, which comes late, dies, and comes back."""
import os
import subprocess
import sys
import unittest

import rospy
import rostest
from sensor_msgs.msg import CameraInfo, Image

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from waiting import Waiter  # noqa: E402

SERVER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "rtsp_server.py")
PORT = "50854"


class VideoTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bench = Waiter()
        cls.images = []
        cls.infos = []
        cls.subscribers = [rospy.Subscriber("image_raw", Image, cls.keep, cls.images, buff_size=2**21),
                           rospy.Subscriber("camera_info", CameraInfo, cls.keep, cls.infos)]

    @classmethod
    def keep(cls, message, where):
        with cls.bench.changed:
            where.append((message, rospy.Time.now()))
            cls.bench.changed.notify_all()

    def wait_for_images(self, what):
        begin = len(self.images)
        self.bench.wait_for(lambda: len(self.images) >= begin + 5, what, 40.0)

    def test_streams_and_comes_back(self):
        server = subprocess.Popen([SERVER, PORT])
        try:
            self.wait_for_images("images come once the server is up")
            image, received = self.images[-1]
            self.assertEqual((image.width, image.height, image.encoding), (352, 288, "bgr8"))
            self.assertEqual(image.header.frame_id, "robot_camera")
            age = (received - image.header.stamp).to_sec()
            self.assertGreaterEqual(age, 0.1, "the latency is subtracted")
            self.assertLess(age, 1.0)
            self.bench.wait_for(lambda: self.infos and self.infos[-1][0].width == 352, "camera_info")
            stamps = [message.header.stamp for message, _ in self.images]
            self.assertEqual(stamps, sorted(stamps))
        finally:
            server.kill()
            server.wait()
        server = subprocess.Popen([SERVER, PORT])
        try:
            # What was on its way when the server died does not count.
            first = len(self.images)
            started = rospy.Time.now()
            self.bench.wait_for(lambda: any(message.header.stamp > started + rospy.Duration(1.0)
                                            for message, _ in self.images[first:]), "images come again", 40.0)
        finally:
            server.kill()
            server.wait()


if __name__ == "__main__":
    rospy.init_node("video_test")
    rostest.rosrun("perennial_nav", "video", VideoTest)
