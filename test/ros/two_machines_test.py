#!/usr/bin/env python3
"""The robot with its driver and the master on one machine, the navigator on another: the link between them is cut, and loses
packets. The robot never moves unguided, and goes on afterwards.

In real time, as two machines have it: a simulated clock would stop with the link. What the robot truly does is what its
simulator says, which runs beside the driver.
"""
import functools
import math
import os
import shutil
import sys
import threading
import unittest

import rosgraph
import rospkg
import rospy
import rostest
import yaml
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from perennial_nav.msg import NavigationState, RepeatGoal, TeachGoal
from sensor_msgs.msg import Image

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import machines  # noqa: E402
from fake_robot import HEIGHT, SCENE_M, WIDTH, view, wait_until  # noqa: E402
from skipping import skip  # noqa: E402
from stack import Stack  # noqa: E402

FOLDER = ""  # of the maps and logs; from the command line
PATH_M, SPEED_MPS = 3.0, 0.5
PIXELS_PER_RAD = 200.0  # of the camera
STATES_PER_IMAGE = 3  # the simulator's state comes 25 times a second
STOP_S = 3.0  # command_timeout_s and a few ticks of a busy computer
UNGUIDED_S = 3.0  # sensor_timeout_s of the navigator, command_timeout_s of the driver, and the same again for the link
GIVE_UP_S = 8.0


@functools.lru_cache(maxsize=None)
def scene(number, left_px):
    return view(number * SCENE_M, left_px)


class Robot:
    """What the simulated robot truly does, a camera on it, and a person who drives it."""

    def __init__(self):
        self.lock = threading.Lock()
        self.states = []  # (time of the camera's stamps, time of the simulator, moving, x, yaw)
        self.start = (0.0, 0.0)  # where the camera believes that the world begins: x, yaw
        self.by_hand = None  # m/s
        self.images = rospy.Publisher("/camera/image_raw", Image, queue_size=1)
        self.commands = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("/cameleon_simulator/state", Odometry, self.on_state, queue_size=100, tcp_nodelay=True)

    def connect(self, nodes):
        wait_until(lambda: self.images.get_num_connections() >= nodes, "subscribers of the images")
        wait_until(lambda: self.commands.get_num_connections() >= nodes + 1, "subscribers of the commands")
        wait_until(lambda: self.states, "the simulator")

    def tick(self, seconds):
        """Time goes on by itself."""

    def on_state(self, message):
        moving = message.twist.twist.linear.x != 0.0 or message.twist.twist.angular.z != 0.0
        orientation = message.pose.pose.orientation
        yaw = 2.0 * math.atan2(orientation.z, orientation.w)
        now = rospy.Time.now()
        with self.lock:
            self.states.append((now.to_sec(), message.header.stamp.to_sec(), moving, message.pose.pose.position.x, yaw))
            number = len(self.states)
        if self.by_hand is not None:
            self.commands.publish(self.command(self.by_hand))
        if number % STATES_PER_IMAGE == 0:
            self.images.publish(self.image(now, number))

    @staticmethod
    def command(forward):
        twist = Twist()
        twist.linear.x = forward
        return twist

    def image(self, stamp, number):
        message = Image(width=WIDTH, height=HEIGHT, step=WIDTH, encoding="mono8")
        message.header.stamp, message.header.frame_id = stamp, "camera"
        left_px = int(round((self.newest()[4] - self.start[1]) * PIXELS_PER_RAD))
        pixels = scene(int(max(self.x(), 0.0) / SCENE_M), min(max(left_px, -100), 100)).copy()
        pixels[0, :4] = list(number.to_bytes(4, "little"))  # every real camera has noise
        message.data = pixels.tobytes()
        return message

    def newest(self):
        with self.lock:
            return self.states[-1]

    def x(self):
        return self.newest()[3] - self.start[0]

    def now(self):
        """Of the simulator: it counts its loops."""
        return self.newest()[1]

    def moving(self):
        return self.newest()[2]

    def since(self, simulator_s):
        with self.lock:
            return [state for state in self.states if state[1] > simulator_s]

    def put_back(self):
        """Where it stands is where the world begins."""
        wait_until(lambda: not self.moving(), "the robot to stand")
        newest = self.newest()
        self.start = (newest[3], newest[4])


class TwoMachines(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.machines = machines.Machines()
        cls.addClassCleanup(cls.machines.end)
        os.environ["ROS_IP"], os.environ["ROS_MASTER_URI"] = machines.ROBOT, "http://%s:11311" % machines.ROBOT
        cls.start(machines.ROBOT, "master", "rosmaster", "--core", "-p", "11311")
        wait_until(rosgraph.is_master_online, "the master")
        cls.start_node(machines.ROBOT, "cameleon_simulator", port=50004)
        cls.start_node(machines.ROBOT, "cameleon_driver", "cameleon", robot_host="127.0.0.1")
        cls.start_node(machines.COMPUTER, "teach_recorder", "teach_recorder", map_folder=FOLDER)
        cls.start_node(machines.COMPUTER, "map_manager", "map_manager", map_folder=FOLDER)
        cls.start_node(machines.COMPUTER, "repeat_navigator", "repeat_navigator", give_up_s=GIVE_UP_S)
        rospy.init_node("two_machines_test")
        cls.robot = Robot()
        cls.stack = Stack(cls.robot)
        cls.teach()

    @classmethod
    def start(cls, address, name, *command):
        return cls.machines.start(address, os.path.join(FOLDER, name + ".log"), *command)

    @classmethod
    def start_node(cls, address, name, config=None, **parameters):
        loaded = {}
        if config:
            folder = os.path.join(rospkg.RosPack().get_path("perennial_nav"), "config")
            with open(os.path.join(folder, config + ".yaml")) as file:
                loaded = yaml.safe_load(file)
        loaded.update(parameters)
        rosgraph.Master("/two_machines_test").setParam("/" + name, loaded)
        return cls.start(address, name, "rosrun", "perennial_nav", name + "_node", "image:=/camera/image_raw",
                         "__name:=" + name)  # fmt: skip

    @classmethod
    def teach(cls):
        cls.robot.put_back()
        cls.stack.start(cls.stack.teach, TeachGoal(map_name="path"))
        cls.robot.by_hand = SPEED_MPS
        wait_until(lambda: cls.robot.x() > PATH_M, "the robot to be driven along the path")
        cls.robot.by_hand = None
        cls.stack.teach.cancel_goal()
        result = cls.stack.result(cls.stack.teach)
        assert result.success, result.message

    def setUp(self):
        self.robot.put_back()
        del self.stack.states[:], self.stack.registrations[:]
        self.begun_s = self.robot.now()
        self.stack.start(self.stack.repeat, RepeatGoal(map_name="path"))

    def tearDown(self):
        self.machines.restore()
        self.stack.end(self.stack.repeat)

    # --- parts of the tests ---

    def drive_to(self, x_m):
        wait_until(lambda: self.stack.done(self.stack.repeat) or self.robot.x() > x_m, "the robot to drive")
        self.assertFalse(self.stack.done(self.stack.repeat), self.reasons())
        self.assertTrue(self.robot.moving())

    def cut(self, cutting, until):
        """Cuts the link until something happens."""
        cut_s = self.robot.now()
        cutting()
        wait_until(lambda: not self.robot.moving(), "the robot to stop")
        still_s = self.robot.now()
        print("stood %.2f s after the link was cut" % (still_s - cut_s))
        self.assertLess(still_s - cut_s, STOP_S)
        wait_until(until, "the time to restore the link")
        self.assertFalse(any(state[2] for state in self.robot.since(still_s)), "it must go on standing")
        self.machines.restore()

    def stands_for(self, seconds):
        begin = []

        def over():
            begin[:] = begin or [self.robot.now()]
            return self.robot.now() > begin[0] + seconds

        return over

    def said(self, log, text):
        with open(os.path.join(FOLDER, log + ".log"), errors="replace") as file:
            return text in file.read()

    def reasons(self):
        return sorted({"%s: %s" % (state.state, state.reason) for state in self.stack.states})

    def assert_succeeds(self):
        result = self.stack.result(self.stack.repeat)
        self.assertTrue(result.success, result.reason)
        self.assertAlmostEqual(self.robot.x(), PATH_M, delta=0.3)

    def assert_guided(self):
        """Whenever the robot moved, what it saw shortly before had been recognised, sooner or later."""
        recognised = sorted(m.header.stamp.to_sec() for m in self.stack.registrations if m.has_displacement)
        longest_s = 0.0
        for now, _, moving, _, _ in self.robot.since(self.begun_s):
            if moving:
                before = [stamp for stamp in recognised if stamp <= now]
                self.assertTrue(before, "it moved before it had recognised anything")
                longest_s = max(longest_s, now - before[-1])
        print("moved at most %.2f s after an image that was recognised" % longest_s)
        self.assertLess(longest_s, UNGUIDED_S)

    # --- the tests ---

    def test_link_that_is_cut_for_a_while(self):
        for x_m, cutting in ((0.5, self.machines.unplug), (1.5, self.machines.silence)):
            self.drive_to(x_m)
            self.cut(cutting, self.stands_for(1.0))
            wait_until(self.robot.moving, "the robot to go on")
        self.assert_succeeds()
        self.assert_guided()
        stopped = [state.reason for state in self.stack.states if state.state == NavigationState.STOPPED]
        self.assertTrue(any("no " in reason for reason in stopped), self.reasons())

    def test_link_that_is_cut_for_too_long(self):
        self.drive_to(0.5)
        self.cut(self.machines.silence, lambda: self.said("repeat_navigator", "repeat failed"))
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn("check its topic", result.reason)
        self.assertFalse(self.robot.moving())
        self.assert_guided()

    def test_link_that_loses_packets(self):
        self.machines.lose(0.2)
        self.assert_succeeds()
        self.assert_guided()


if __name__ == "__main__":
    FOLDER = rospy.myargv()[1]
    problem = machines.enter()
    if problem:
        skip("two_machines", "there can be no two machines here: " + problem)
    else:
        shutil.rmtree(FOLDER, ignore_errors=True)
        os.makedirs(FOLDER)
        rostest.rosrun("perennial_nav", "two_machines", TwoMachines, sys.argv)
