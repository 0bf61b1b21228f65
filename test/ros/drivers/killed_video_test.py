#!/usr/bin/python3
"""The node of a camera on the network is killed while the robot repeats: the robot stands until there is a new one."""
import os
import shutil
import sys
import threading

import rospy
import rostest

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import rtsp_server  # noqa: E402
from fake_robot import HEIGHT, WIDTH  # noqa: E402
from killing import kill, wait_for_new  # noqa: E402
from real_time import SPEED_MPS, RealTimeTest, Robot  # noqa: E402

FOLDER = ""  # of the maps; from the command line
PORT, RATE_HZ = "50855", 10
MAP_DELAY_S = 2.0  # at most: an image that is late by more than latency_s shows the map another place than the odometer


class NetworkCamera:
    """In the place of a publisher of images: the newest one is shown on the network."""

    def __init__(self):
        self.pixels = bytes(WIDTH * HEIGHT)
        self.shown = 0
        arguments = (PORT, self.picture, WIDTH, HEIGHT, RATE_HZ)
        threading.Thread(target=rtsp_server.serve, args=arguments, daemon=True).start()

    def picture(self):
        self.shown += 1
        return self.pixels

    def publish(self, message):
        self.pixels = bytes(message.data)

    def get_num_connections(self):
        return min(self.shown, 1)


class KilledVideo(RealTimeTest):
    @classmethod
    def setUpClass(cls):
        robot = Robot()
        robot.images.unregister()
        robot.images = NetworkCamera()
        cls.begin(robot)

    def test_video(self):
        self.drive_to(1.0)
        mark = self.robot.mark()
        killed = kill("/cameleon_camera/cameleon_video")
        self.assert_stops(mark)
        wait_for_new("/cameleon_camera/cameleon_video", killed)
        self.assert_succeeds(within_m=MAP_DELAY_S * SPEED_MPS)
        self.assert_guided(recognised=False)  # where its delay shows the last scene still, it is blind for a while
        self.assertTrue([told for told in self.stack.states if "no image" in told.reason], "why it stood")


if __name__ == "__main__":
    FOLDER = rospy.myargv()[1]
    shutil.rmtree(FOLDER, ignore_errors=True)
    rospy.init_node("killed_video_test")
    try:
        rostest.rosrun("perennial_nav", "killed_video", KilledVideo, sys.argv)
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)
