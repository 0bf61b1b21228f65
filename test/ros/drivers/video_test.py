#!/usr/bin/python3
"""The video node, by either of OpenCV's backends, against a real RTSP server, which comes late, dies, and comes back."""
import os
import signal
import statistics
import subprocess
import sys
import unittest

import roslib.packages
import rospy
import rostest
from sensor_msgs.msg import CameraInfo, Image

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from waiting import Waiter  # noqa: E402

SERVER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "rtsp_server.py")
PORT = "50854"
BACKENDS = ("ffmpeg", "gstreamer")
PATIENCE_S = 60.0


def age(image, now_s):
    """How long ago the picture was taken: it says so itself, in tenths of a second, modulo 25.6 s."""
    row = image.data[image.step * (image.height // 2):]
    tenths = 0
    for bit in range(8):
        tenths = 2 * tenths + (row[3 * (image.width // 16 + bit * image.width // 8)] > 127)
    return (10.0 * now_s - tenths) % 256 / 10.0


class VideoTest(unittest.TestCase):
    def setUp(self):
        self.bench = Waiter()
        self.images = {backend: [] for backend in BACKENDS}  # (message, when it came, its age then)
        self.infos = {backend: [] for backend in BACKENDS}
        self.processes = []
        binary = roslib.packages.find_node("perennial_nav", "cameleon_video_node")[0]
        self.nodes = {}
        for backend in BACKENDS:
            self.nodes[backend] = self.start([binary, "__name:=cameleon_video"], ROS_NAMESPACE="/" + backend)
            rospy.Subscriber("/%s/image_raw" % backend, Image, self.on_image, backend, buff_size=2**21)
            rospy.Subscriber("/%s/camera_info" % backend, CameraInfo, self.infos[backend].append)

    def tearDown(self):
        for process in self.processes:
            process.send_signal(signal.SIGCONT)
            process.kill()
            process.wait()

    def start(self, command, **environment):
        process = subprocess.Popen(command, env=dict(os.environ, **environment))
        self.processes.append(process)
        return process

    def on_image(self, message, backend):
        now = rospy.Time.now()
        with self.bench.changed:
            self.images[backend].append((message, now, age(message, now.to_sec())))
            self.bench.changed.notify_all()

    def wait_for_images(self, backend, what, number=10):
        begin = len(self.images[backend])
        self.bench.wait_for(lambda: len(self.images[backend]) >= begin + number, backend + ": " + what, PATIENCE_S)

    def newest_age(self, backend):
        """Of most of the newest images; a single one may have been held up by anything."""
        return statistics.median(item[2] for item in self.images[backend][-7:])

    def test_streams_and_comes_back(self):
        server = self.start([SERVER, PORT])
        for backend in BACKENDS:
            self.wait_for_images(backend, "images come once the server is up")
            image, received, _ = self.images[backend][-1]
            self.assertEqual((image.width, image.height, image.encoding), (352, 288, "bgr8"))
            self.assertEqual(image.header.frame_id, "robot_camera")
            self.bench.wait_for(lambda: self.infos[backend] and self.infos[backend][-1].width == 352, "camera_info")
            stamps = [item[0].header.stamp for item in self.images[backend]]
            self.assertEqual(stamps, sorted(stamps))
        server.kill()
        server.wait()
        begin = {backend: len(self.images[backend]) for backend in BACKENDS}
        # What was on its way when the server died does not count.
        restarted = rospy.Time.now()
        self.start([SERVER, PORT])
        for backend in BACKENDS:
            self.bench.wait_for(lambda: any(item[1].to_sec() - item[2] > restarted.to_sec() + 0.2
                                            for item in self.images[backend][begin[backend]:]),
                                backend + ": images come again", PATIENCE_S)

    def test_stamps_are_honest(self):
        self.start([SERVER, PORT])
        for backend in BACKENDS:
            self.wait_for_images(backend, "images come", 20)
            errors = [(received - image.header.stamp).to_sec() - true_age
                      for image, received, true_age in self.images[backend][-10:]]
            print("%s: images are %.1f s old; the stamps say %+.2f s" %
                  (backend, self.newest_age(backend), statistics.median(errors)))
            self.assertLess(abs(statistics.median(errors)), 0.5)

    def test_only_the_newest_image_counts(self):
        """A node that was held up for seconds publishes the present afterwards, not the past."""
        self.start([SERVER, PORT])
        for backend, other in (BACKENDS, BACKENDS[::-1]):
            self.wait_for_images(backend, "images come")
            self.wait_for_images(other, "images come")
            self.nodes[backend].send_signal(signal.SIGSTOP)
            self.wait_for_images(other, "meanwhile", 30)
            stopped = len(self.images[backend])
            self.nodes[backend].send_signal(signal.SIGCONT)
            self.bench.wait_for(lambda: len(self.images[backend]) > stopped + 7 and self.newest_age(backend) < 1.0,
                                backend + ": it shows the present again", PATIENCE_S)


if __name__ == "__main__":
    rospy.init_node("video_test")
    rostest.rosrun("perennial_nav", "video", VideoTest)
