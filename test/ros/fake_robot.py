"""A robot for tests of the real nodes: a camera in a corridor of noise, odometry, and time that goes on when the nodes are
done with an image. Nothing in it depends on how fast the machine is."""
import math
import threading
import time

import numpy as np
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from perennial_nav.msg import Processed
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image

WIDTH, HEIGHT = 320, 200
SCENE_M = 2.0  # the scene changes every so many metres
STEP_S = 0.1
PATIENCE_S = 60.0  # real time


def wait_until(condition, what, patience_s=PATIENCE_S):
    """Waits for a condition, failing loudly after a time-out of real time."""
    deadline = time.monotonic() + patience_s
    while not condition():
        if rospy.is_shutdown() or time.monotonic() > deadline:
            raise AssertionError("waited in vain for " + what)
        rospy.rostime.wallsleep(0.01)


def view(distance_m, left_px=0):
    """What the camera sees at a place, turned to the left by left_px."""
    random = np.random.RandomState(1000 + int(distance_m / SCENE_M + 1e-6))
    noise = random.rand(HEIGHT + 8, WIDTH + 208)
    for axis in (0, 1):  # blobs that the detector likes
        for _ in range(2):
            noise = sum(np.roll(noise, shift, axis) for shift in (-2, -1, 0, 1, 2))
    noise = (noise - noise.min()) / (noise.max() - noise.min())
    return (255 * noise[:HEIGHT, 100 - left_px : 100 - left_px + WIDTH]).astype(np.uint8)


class FakeRobot:
    def __init__(self):
        self.x = 0.0
        self.time = 1000.0
        self.left_px = 0
        self.speed = None  # m/s; None: as commanded
        self.loop_m = math.inf  # a closed path of this length is seen
        self.image_changes = {}  # fields of the image message to set otherwise
        self.odometry_changes = {}
        self.sends_images = self.sends_odometry = True
        self.image_late_s = self.odometry_late_s = 0.0  # how old they are when they come
        self.frozen = False  # the camera repeats one image
        self.images_taken = 0
        self.commands = []
        self.answered = set()
        self.lock = threading.Lock()
        self.images = rospy.Publisher("/camera/image_raw", Image, queue_size=100)
        self.odometry = rospy.Publisher("/odom", Odometry, queue_size=100)
        self.clock = rospy.Publisher("/clock", Clock, queue_size=100)
        self.teleop = rospy.Publisher("/cmd_vel", Twist, queue_size=100)
        rospy.Subscriber("/cmd_vel", Twist, self.on_command, queue_size=1000)
        rospy.Subscriber("/processed", Processed, self.on_processed, queue_size=1000)

    def on_command(self, message):
        with self.lock:
            self.commands.append(message)

    def on_processed(self, message):
        with self.lock:
            self.answered.add((message.node, message.header.stamp.to_nsec()))

    def command(self):
        with self.lock:
            return self.commands[-1] if self.commands else Twist()

    def connect(self, nodes):
        """Until the nodes listen, what is sent to them is lost."""
        wait_until(lambda: self.images.get_num_connections() >= nodes, "subscribers of the images")
        wait_until(lambda: self.odometry.get_num_connections() >= nodes, "subscribers of the odometry")
        self.tick(0.0)

    def tick(self, seconds):
        self.time += seconds
        self.clock.publish(Clock(rospy.Time.from_sec(self.time)))

    def step(self, wait_for=None):
        """Time goes on by one image; returns its stamp. wait_for: names of nodes that must be done with it; late odometry
        keeps them waiting."""
        speed = self.command().linear.x if self.speed is None else self.speed
        self.x += speed * STEP_S
        self.tick(STEP_S)
        stamp = rospy.Time.from_sec(self.time - self.image_late_s)
        if self.sends_odometry:
            self.odometry.publish(self.odometry_message(rospy.Time.from_sec(self.time - self.odometry_late_s), speed))
        if self.sends_images:
            self.images.publish(self.image_message(stamp))
            for node in (wait_for or []) if self.odometry_late_s == 0.0 else []:
                answer = (node, stamp.to_nsec())
                wait_until(lambda: self.has_answer(answer), "%s to process an image" % node)
        return stamp

    def has_answer(self, answer):
        with self.lock:
            return answer in self.answered

    def odometry_message(self, stamp, speed):
        message = Odometry()
        message.header.stamp = stamp
        message.header.frame_id, message.child_frame_id = "odom", "base_link"
        message.pose.pose.position.x = self.odometry_changes.get("x", self.x)
        message.pose.pose.orientation.w = 1.0
        message.twist.twist.linear.x = speed
        return message

    def image_message(self, stamp):
        message = Image()
        message.header.stamp, message.header.frame_id = stamp, "camera"
        message.width, message.height, message.step, message.encoding = WIDTH, HEIGHT, WIDTH, "mono8"
        pixels = view(max(self.x, 0.0) % self.loop_m, self.left_px)
        if not self.frozen:  # every real camera has noise
            self.images_taken += 1
            pixels[0, :4] = np.frombuffer(np.uint32(self.images_taken).tobytes(), np.uint8)
        message.data = pixels.tobytes()
        for name, value in self.image_changes.items():
            setattr(message, name, value)
        return message

    def restart(self, x=0.0):
        """Stands at x again, with nothing changed."""
        self.x, self.left_px, self.speed, self.loop_m = x, 0, None, math.inf
        self.image_changes, self.odometry_changes = {}, {}
        self.sends_images = self.sends_odometry = True
        self.image_late_s = self.odometry_late_s = 0.0
        self.frozen = False
        with self.lock:
            self.commands = []

    def stands(self):
        command = self.command()
        return math.isclose(command.linear.x, 0.0) and math.isclose(command.angular.z, 0.0)
