#!/usr/bin/python3
"""The real driver against the simulated robot: driving, stopping, and every fault of the wire."""
import math
import os
import socket
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, JointState
from std_msgs.msg import Bool
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from robot_bench import RobotBench, yaw_of  # noqa: E402

# A command takes a tick of the driver (0.05 s), the robot's loop (0.04 s), and the two ways there; the rest is for a machine
# that is busy with other things.
REACTION_S = 0.35
COMMAND_TIMEOUT_S = 0.5
ACCELERATION, BRAKING = 1.0, 2.0  # m/s^2, of config/cameleon.yaml


class CameleonTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bench = RobotBench()
        cls.odometry = []
        cls.diagnostics = {}
        cls.battery = []
        cls.joints = []
        cls.transforms = {}  # stamp -> odom to base_link
        cls.stop = rospy.Publisher("emergency_stop", Bool, queue_size=1, latch=True)
        cls.subscribers = [
            rospy.Subscriber("odom", Odometry, cls.on_odometry, tcp_nodelay=True),
            rospy.Subscriber("battery", BatteryState, lambda message: cls.keep(cls.battery, message)),
            rospy.Subscriber("joint_states", JointState, lambda message: cls.keep(cls.joints, message)),
            rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics),
            rospy.Subscriber("/tf", TFMessage, cls.on_transforms),
        ]

    @classmethod
    def keep(cls, where, message):
        with cls.bench.changed:
            where.append(message)
            cls.bench.changed.notify_all()

    @classmethod
    def on_odometry(cls, message):
        cls.keep(cls.odometry, message)

    @classmethod
    def on_transforms(cls, message):
        with cls.bench.changed:
            for transform in message.transforms:
                if (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_link"):
                    cls.transforms[transform.header.stamp] = transform.transform
            cls.bench.changed.notify_all()

    @classmethod
    def on_diagnostics(cls, message):
        with cls.bench.changed:
            for status in message.status:
                cls.diagnostics[status.name.split(": ")[-1]] = (
                    status.level, status.message, {value.key: value.value for value in status.values})
            cls.bench.changed.notify_all()

    def setUp(self):
        self.bench.drive(0.3)
        self.bench.wait_until_moving("the robot is ready")

    def tearDown(self):
        self.bench.release()
        self.bench.inject("latency", 0.0)
        self.stop.publish(False)
        self.bench.wait_until_still()

    def diagnostic(self, name, key):
        return int(float(self.diagnostics.get(name, (0, "", {}))[2].get(key, "0")))

    def position(self):
        position = self.odometry[-1].pose.pose.position
        return position.x, position.y

    def assert_odometry_never_jumped(self, first):
        """Consecutive messages differ by what a robot at 0.5 m/s can do, however they were delayed."""
        with self.bench.changed:
            messages = self.odometry[first:]
        for before, after in zip(messages, messages[1:]):
            way = math.hypot(after.pose.pose.position.x - before.pose.pose.position.x,
                             after.pose.pose.position.y - before.pose.pose.position.y)
            elapsed = (after.header.stamp - before.header.stamp).to_sec()
            self.assertLess(way, 0.5 * (elapsed + 0.1))

    def stand_still(self):
        """Pose in the simulator's and in the driver's frame once the robot stands."""
        self.bench.release()
        self.bench.wait_until_still()
        self.bench.wait_loops(20)
        with self.bench.changed:
            odometry = self.odometry[-1]
            return self.bench.states[-1][3:], self.position() + (yaw_of(odometry),)

    @staticmethod
    def relative(begin, end):
        """Where `end` lies, seen from `begin`."""
        x, y = end[0] - begin[0], end[1] - begin[1]
        c, s = math.cos(begin[2]), math.sin(begin[2])
        return c * x + s * y, -s * x + c * y, math.remainder(end[2] - begin[2], 2.0 * math.pi)

    def test_the_simulator_serves_this_computer_only(self):
        """By default, as another address of this computer shows: it would be served by one that listens on all."""
        port = rospy.get_param("cameleon_simulator/port")
        with self.assertRaises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.2", port), 10.0).close()

    def test_drives_and_tells_where_it_is(self):
        true_begin, begin = self.stand_still()
        first = len(self.odometry)
        self.bench.drive(0.3, 0.2)
        self.bench.wait_for(lambda: self.bench.states[-1][1:3] == (0.3, 0.2), "the robot drives as told")
        self.bench.wait_for(lambda: abs(self.odometry[-1].twist.twist.linear.x - 0.3) < 0.03, "the twist says so")
        self.bench.wait_for(lambda: abs(self.odometry[-1].twist.twist.angular.z - 0.2) < 0.05, "the turn rate too")
        self.bench.wait_loops(50)
        true_end, end = self.stand_still()
        true_way = self.relative(true_begin, true_end)
        self.assertGreater(true_way[0], 0.5)
        self.assertGreater(true_way[2], 0.3)
        # The odometers count millimetres on tracks that are 0.4 m apart.
        for odometry, truth in zip(self.relative(begin, end), true_way):
            self.assertAlmostEqual(odometry, truth, delta=0.006)
        message = self.odometry[-1]
        self.assertEqual((message.header.frame_id, message.child_frame_id), ("odom", "base_link"))
        self.assertGreater(message.header.stamp.to_sec(), 1000.0)
        self.assertEqual(message.twist.twist.linear.x, 0.0)
        self.assertGreater(message.pose.covariance[35], self.odometry[first].pose.covariance[35])
        self.assert_odometry_never_jumped(first)

    def test_keeps_to_the_limits(self):
        begin = self.bench.now()
        self.bench.drive(9.0, 9.0)
        self.bench.wait_for(lambda: self.bench.states[-1][1:3] == (0.5, 0.5), "the robot drives at its limits")
        self.bench.drive(-9.0, -9.0)
        self.bench.wait_for(lambda: self.bench.states[-1][1:3] == (-0.5, -0.5), "and backward")
        with self.bench.changed:
            states = [state for state in self.bench.states if state[0] >= begin]
        self.assertLessEqual(max(abs(state[1]) for state in states), 0.5)
        self.assertLessEqual(max(abs(state[2]) for state in states), 0.5)

    def time_between(self, begin, low, high):
        """Of the simulator, from the last state at most `low` to the first one of `high` that follows `begin`, m/s."""
        with self.bench.changed:
            states = [state for state in self.bench.states if state[0] >= begin]
        end = next(i for i, state in enumerate(states) if state[1] >= high)
        start = max(i for i in range(end) if states[i][1] <= low)
        return states[end][0] - states[start][0]

    def test_accelerates_no_faster_than_allowed(self):
        ramps, stops = [], []
        for _ in range(5):
            self.bench.drive(-0.5)
            self.bench.wait_for(lambda: self.bench.states[-1][1] == -0.5, "backward")
            begin = self.bench.now()
            self.bench.drive(0.5)
            self.bench.wait_for(lambda: self.bench.states[-1][1] == 0.5, "forward")
            stops.append(self.time_between(begin, -0.5, -0.01))
            ramps.append(self.time_between(begin, 0.06, 0.5))
        # Single commands may come late, which squeezes what a ramp seems to take by some loops; not that of most of them.
        self.assertGreater(sorted(ramps)[2], (0.5 - 0.06) / ACCELERATION - 0.06, ramps)
        self.assertLess(sorted(ramps)[2], (0.5 - 0.06) / ACCELERATION + 0.3, ramps)
        self.assertGreater(sorted(stops)[2], 0.4 / BRAKING - 0.06, stops)

    def test_tells_its_tilt(self):
        self.bench.inject("pitch", 10)
        self.bench.inject("roll", -5)
        def tilt():
            q = self.odometry[-1].pose.pose.orientation
            return (math.degrees(math.asin(2.0 * (q.w * q.y - q.z * q.x))),
                    math.degrees(math.atan2(2.0 * (q.w * q.x + q.y * q.z), 1.0 - 2.0 * (q.x * q.x + q.y * q.y))))
        self.bench.wait_for(lambda: abs(tilt()[0] - 10.0) < 1e-6 and abs(tilt()[1] + 5.0) < 1e-6, "pitch and roll in odom")
        self.bench.inject("pitch", 0)
        self.bench.inject("roll", 0)
        self.bench.wait_for(lambda: tilt() == (0.0, 0.0), "level again")

    def test_broadcasts_the_pose_of_its_odometry(self):
        first = len(self.odometry)
        def pair():
            with self.bench.changed:
                return next((message for message in self.odometry[first:] if message.header.stamp in self.transforms), None)
        self.bench.wait_for(lambda: pair() is not None, "a transform of the same moment")
        message = pair()
        transform, pose = self.transforms[message.header.stamp], message.pose.pose
        self.assertEqual((transform.translation.x, transform.translation.y), (pose.position.x, pose.position.y))
        self.assertEqual(transform.rotation, pose.orientation)

    def test_moves_the_flippers(self):
        self.bench.drive(0.0, 0.0, 9.0)
        self.bench.wait_for(lambda: self.joints and self.joints[-1].position[0] > 0.05, "the flippers go up")
        begin = self.joints[-1].position[0]
        began = self.bench.now()
        self.bench.wait_for(lambda: self.joints[-1].position[0] > begin + 0.03, "and on")
        # No faster than the 47 units that the robot's serial frame can hold; the position comes in whole degrees.
        self.assertLess((self.joints[-1].position[0] - begin - math.radians(1.0)) / (self.bench.now() - began), 0.047 + 0.01)
        self.bench.drive(0.0, 0.0, -9.0)
        self.bench.wait_for(lambda: self.joints[-1].position[0] < 0.02, "and down")

    def test_stops_when_commands_stop(self):
        last = self.bench.release()
        self.bench.wait_until_still()
        took = self.bench.first_still_after(last) - last
        self.assertGreater(took, COMMAND_TIMEOUT_S - 0.15)
        self.assertLess(took, COMMAND_TIMEOUT_S + REACTION_S)

    def test_stops_when_commands_are_not_numbers(self):
        last = self.bench.now()
        self.bench.drive(float("nan"))
        self.bench.wait_until_still()
        self.assertLess(self.bench.first_still_after(last) - last, COMMAND_TIMEOUT_S + REACTION_S)

    def test_emergency_stop_holds_until_cleared(self):
        engaged = self.bench.now()
        self.stop.publish(True)
        self.bench.wait_until_still()
        stopped = self.bench.first_still_after(engaged)
        self.assertLess(stopped - engaged, REACTION_S)
        self.bench.wait_loops(40)  # commands go on meanwhile
        self.assertFalse(self.bench.moved_since(stopped))
        self.bench.wait_for(lambda: "emergency stop" in self.diagnostics.get("robot", ("", "", {}))[1],
                            "diagnostics tell why the robot stands")
        self.bench.release()
        self.bench.wait_loops(5)
        self.stop.publish(False)
        self.bench.wait_loops(25)
        self.assertFalse(self.bench.moved_since(stopped), "clearing alone must not move the robot")
        self.bench.drive(0.3)
        self.bench.wait_until_moving("the robot drives again")

    def survive(self, fault, value, loops, reconnects):
        """Drives through a fault: afterwards the robot obeys, and odometry goes on without a jump."""
        first = len(self.odometry)
        self.bench.inject(fault, value)
        self.bench.wait_loops(loops)
        self.bench.wait_until_moving("the robot moves again after " + fault)
        begin = self.position()
        self.bench.wait_for(lambda: math.dist(self.position(), begin) > 0.1, "odometry goes on after " + fault)
        self.assert_odometry_never_jumped(first)
        if reconnects is not None:
            self.bench.wait_for(lambda: self.diagnostic("connection", "connections") >= reconnects, "reconnection counted")

    def test_survives_stray_bytes(self):
        self.survive("stray_bytes", 100, 5, None)
        self.bench.wait_for(lambda: self.diagnostic("connection", "stray bytes") >= 100, "stray bytes are counted")

    def test_survives_half_frames(self):
        for size in (1, 3, 8, 16, 31):
            self.survive("half_frame", size, 3, None)

    def test_survives_wrong_types(self):
        bad = self.diagnostic("connection", "bad frames")
        self.survive("wrong_type", 3, 5, None)
        self.survive("wrong_validity", 3, 5, None)
        self.bench.wait_for(lambda: self.diagnostic("connection", "bad frames") >= bad + 6, "bad frames are counted")

    def test_survives_a_jump_of_the_odometers(self):
        jumps = self.diagnostic("robot", "odometer jumps")
        self.survive("jump", 5000, 5, None)
        self.survive("jump", -1e8, 5, None)
        self.bench.wait_for(lambda: self.diagnostic("robot", "odometer jumps") >= jumps + 2, "jumps are counted")

    def test_survives_silence(self):
        self.survive("silence", 0.3, 10, None)
        connections = self.diagnostic("connection", "connections")
        self.survive("silence", 1.5, 40, connections + 1)

    def test_survives_a_frozen_robot(self):
        connections = self.diagnostic("connection", "connections")
        self.survive("freeze", 1.5, 40, connections + 1)

    def test_survives_a_restart(self):
        connections = self.diagnostic("connection", "connections")
        self.survive("restart", 1.0, 30, connections + 1)

    def test_survives_latency(self):
        self.survive("latency", 0.3, 20, None)
        self.bench.release()
        last = self.bench.now()
        self.bench.wait_until_still()
        self.assertLess(self.bench.first_still_after(last) - last, COMMAND_TIMEOUT_S + 0.3 + REACTION_S)

    def test_stands_still_after_reconnecting_until_a_fresh_command(self):
        connections = self.diagnostic("connection", "connections")
        self.bench.inject("close", 1.0)
        self.bench.wait_loops(3)
        self.bench.release()
        self.bench.wait_until_still("the robot's own watchdog stops it")
        still = self.bench.now()
        self.bench.wait_for(lambda: self.diagnostic("connection", "connections") > connections, "reconnected")
        self.bench.wait_loops(25)
        self.assertFalse(self.bench.moved_since(still))
        self.bench.drive(0.3)
        self.bench.wait_until_moving("a fresh command moves it")

    def test_reports_battery_and_flippers(self):
        self.bench.inject("battery", 10)
        self.bench.wait_for(lambda: self.battery and abs(self.battery[-1].percentage - 0.10) < 1e-6, "battery level")
        self.bench.wait_for(lambda: "battery low" in self.diagnostics.get("robot", ("", "", {}))[1], "battery warning")
        self.bench.wait_for(lambda: self.joints and self.joints[-1].name == ["flipper_joint"], "flipper")
        self.bench.inject("battery", 80)

    def test_unknown_faults_are_refused(self):
        answer = self.bench.fault_service("no_such_fault", 1.0)
        self.assertFalse(answer.success)
        self.assertIn("half_frame", answer.message)


if __name__ == "__main__":
    rospy.init_node("cameleon_test")
    rostest.rosrun("perennial_nav", "cameleon", CameleonTest)
