"""Tests in real time with a simulated robot behind its real driver: a camera on the robot, a person who teaches it a path, and
what the robot truly did, as its simulator says."""
import collections
import functools
import math
import threading
import unittest

import rospy
from fake_robot import HEIGHT, SCENE_M, WIDTH, view, wait_until
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from perennial_nav.msg import Processed, RepeatGoal, TeachGoal
from sensor_msgs.msg import Image
from stack import Stack

PATH_M, SPEED_MPS = 3.0, 0.5
PIXELS_PER_RAD = 200.0  # of the camera
STATES_PER_IMAGE = 3  # the simulator's state comes 25 times a second
STOP_S = 3.0  # longest of the time-outs that stop the robot, and as much again for a busy computer
UNGUIDED_S = 3.0  # sensor_timeout_s of the navigator, command_timeout_s of the driver, and as much again

# stamp_s: on the camera's clock; simulator_s: in loops of the simulator, which begins anew when it is started anew.
State = collections.namedtuple("State", "stamp_s simulator_s moving x yaw")


@functools.lru_cache(maxsize=None)
def scene(number, left_px):
    return view(number * SCENE_M, left_px)


class Robot:
    def __init__(self, camera="/camera/image_raw"):
        self.lock = threading.Lock()
        self.states = []
        self.moved_m = 0.0  # before the simulator was started anew
        self.start = State(0.0, 0.0, False, 0.0, 0.0)  # where the world of the camera begins
        self.by_hand = None  # m/s
        self.images = rospy.Publisher(camera, Image, queue_size=1)
        self.commands = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("/cameleon_simulator/state", Odometry, self.on_state, queue_size=100, tcp_nodelay=True)

    def connect(self, nodes):
        wait_until(lambda: self.images.get_num_connections() > 0, "a subscriber of the images")
        # Recorder, navigator and driver.
        wait_until(lambda: self.commands.get_num_connections() > nodes, "subscribers of the commands")
        wait_until(lambda: self.states, "the simulator")

    def tick(self, seconds):
        """Time goes on by itself."""

    def on_state(self, message):
        pose, twist = message.pose.pose, message.twist.twist
        yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
        stamp, simulator_s = rospy.Time.now(), message.header.stamp.to_sec()
        with self.lock:
            if self.states and simulator_s < self.states[-1].simulator_s:
                self.moved_m = self.states[-1].x
            moving = twist.linear.x != 0.0 or twist.angular.z != 0.0
            self.states.append(State(stamp.to_sec(), simulator_s, moving, self.moved_m + pose.position.x, yaw))
            number = len(self.states)
        if self.by_hand is not None:
            command = Twist()
            command.linear.x = self.by_hand
            self.commands.publish(command)
        if number % STATES_PER_IMAGE == 0:
            self.images.publish(self.image(stamp, number))

    def image(self, stamp, number):
        message = Image(width=WIDTH, height=HEIGHT, step=WIDTH, encoding="mono8")
        message.header.stamp, message.header.frame_id = stamp, "camera"
        left_px = int(round((self.newest().yaw - self.start.yaw) * PIXELS_PER_RAD))
        pixels = scene(int(max(self.x(), 0.0) / SCENE_M), min(max(left_px, -100), 100)).copy()
        pixels[0, :4] = list(number.to_bytes(4, "little"))  # every real camera has noise
        message.data = pixels.tobytes()
        return message

    def newest(self):
        with self.lock:
            return self.states[-1]

    def x(self):
        return self.newest().x - self.start.x

    def moving(self):
        return self.newest().moving

    def mark(self):
        """Of now, for since()."""
        with self.lock:
            return len(self.states)

    def since(self, mark):
        with self.lock:
            return self.states[mark:]

    def put_back(self):
        """Where it stands is where the world begins."""
        wait_until(lambda: not self.moving(), "the robot to stand")
        self.start = self.newest()


class RealTimeTest(unittest.TestCase):
    """What such tests share: a path is taught, and each of them repeats it. setUpClass() of theirs ends with begin()."""

    @classmethod
    def begin(cls, robot):
        cls.robot = robot
        cls.stack = Stack(robot)
        cls.seen = []  # stamps of the images that the navigator is done with
        rospy.Subscriber("/processed", Processed, cls.on_processed, queue_size=100)
        robot.put_back()
        cls.stack.start(cls.stack.teach, TeachGoal(map_name="path"))
        robot.by_hand = SPEED_MPS
        wait_until(lambda: robot.x() > PATH_M, "the robot to be driven along the path")
        robot.by_hand = None
        cls.stack.teach.cancel_goal()
        result = cls.stack.result(cls.stack.teach)
        assert result.success, result.message

    @classmethod
    def on_processed(cls, message):
        if message.node == "repeat_navigator":
            cls.seen.append(message.header.stamp.to_sec())

    def setUp(self):
        wait_until(self.images_arrive, "the navigator to see what the camera sees")
        self.repeat()

    def images_arrive(self):
        return bool(self.seen) and self.robot.since(self.robot.mark() - 50)[0].stamp_s < self.seen[-1]

    def tearDown(self):
        self.stack.end(self.stack.repeat)

    def repeat(self):
        self.robot.put_back()
        del self.stack.states[:], self.stack.registrations[:]
        self.begun = self.robot.mark()
        self.stack.start(self.stack.repeat, RepeatGoal(map_name="path"))

    def drive_to(self, x_m):
        wait_until(lambda: self.stack.done(self.stack.repeat) or self.robot.x() > x_m, "the robot to drive")
        self.assertFalse(self.stack.done(self.stack.repeat), self.reasons())
        self.assertTrue(self.robot.moving())

    def assert_stops(self, mark):
        """Within the time-outs, by the simulator's clock. Returns the mark of when it stood."""
        wait_until(lambda: any(not state.moving for state in self.robot.since(mark)), "the robot to stop")
        states = self.robot.since(mark)
        still = next(i for i, state in enumerate(states) if not state.moving)
        took_s = states[still].simulator_s - states[0].simulator_s
        print("%s: stood after %.2f s" % (self.id(), took_s))
        self.assertLess(took_s, STOP_S)
        return mark + still

    def assert_stood(self, mark):
        self.assertFalse(any(state.moving for state in self.robot.since(mark)), "it must go on standing")

    def reasons(self):
        return sorted({"%s: %s" % (state.state, state.reason) for state in self.stack.states})

    def assert_succeeds(self, within_m=0.3):
        result = self.stack.result(self.stack.repeat)
        self.assertTrue(result.success, result.reason)
        self.assertAlmostEqual(self.robot.x(), PATH_M, delta=within_m)

    def assert_guided(self, recognised=True):
        """Whenever the robot moved, something that it had seen shortly before was recognised, or at least registered."""
        images = [m for m in self.stack.registrations if m.has_displacement or not recognised]
        stamps = sorted(m.header.stamp.to_sec() for m in images)
        moving = [state.stamp_s for state in self.robot.since(self.begun) if state.moving]
        longest_s = 0.0
        for now in moving:
            before = [stamp for stamp in stamps if stamp <= now]
            self.assertTrue(before, "it moved before it had seen anything")
            longest_s = max(longest_s, now - before[-1])
        what = "recognised" if recognised else "registered"
        print("%s: moved at most %.2f s after an image that was %s" % (self.id(), longest_s, what))
        self.assertLess(longest_s, UNGUIDED_S)
