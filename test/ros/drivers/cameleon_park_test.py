#!/usr/bin/python3
"""A path of the embedded world is taught and repeated through the drivers of the CAMELEON and of the TARA."""
import math
import os
import sys
import unittest

import actionlib
import rospy
import rostest
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry, Path
from perennial_nav.msg import RepeatAction, RepeatGoal, TeachAction, TeachGoal
from perennial_nav.srv import SetPark

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from robot_bench import yaw_of  # noqa: E402
from waiting import Waiter  # noqa: E402

LENGTH_M = 7.0
SPEED_MPS = 0.5
LOOK_AHEAD_M = 0.8
START_OFFSET_M = 0.15
PATIENCE_S = 150.0  # wall time for one traversal


class CameleonParkTest(unittest.TestCase):
    def setUp(self):
        self.bench = Waiter()
        self.path = []
        self.track = []  # (x, y, yaw) of the robot, true
        self.driving = False
        self.commands = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        self.subscribers = [rospy.Subscriber("/loop_path", Path, self.on_path),
                            rospy.Subscriber("/ground_truth", Odometry, self.on_truth, queue_size=10)]
        self.teach = actionlib.SimpleActionClient("teach", TeachAction)
        self.repeat = actionlib.SimpleActionClient("repeat", RepeatAction)
        self.set_park = rospy.ServiceProxy("/set_park", SetPark)
        self.bench.wait_for(lambda: self.path and self.track, "the park is there", 60.0)

    def on_path(self, message):
        with self.bench.changed:
            self.path = [(pose.pose.position.x, pose.pose.position.y) for pose in message.poses]
            self.bench.changed.notify_all()

    def on_truth(self, message):
        position = message.pose.pose.position
        with self.bench.changed:
            self.track.append((position.x, position.y, yaw_of(message)))
            self.bench.changed.notify_all()
        if self.driving:
            self.steer()

    def steer(self):
        """Aims at a point of the path ahead, as a person who follows it does."""
        x, y, yaw = self.track[-1]
        nearest = min(range(len(self.path)), key=lambda i: math.dist(self.path[i], (x, y)))
        spacing = math.dist(self.path[0], self.path[1])
        goal = self.path[(nearest + int(LOOK_AHEAD_M / spacing)) % len(self.path)]
        error = math.remainder(math.atan2(goal[1] - y, goal[0] - x) - yaw, 2.0 * math.pi)
        twist = Twist()
        twist.linear.x = SPEED_MPS
        twist.angular.z = max(-0.5, min(0.5, 1.2 * error))
        self.commands.publish(twist)

    def travelled(self):
        return sum(math.dist(a[:2], b[:2]) for a, b in zip(self.track, self.track[1:]))

    def place(self, lateral_m):
        answer = self.set_park(lateral_m, 0.0, "", False)
        self.assertTrue(answer.success, answer.message)
        with self.bench.changed:
            self.track = []
        self.bench.wait_for(lambda: len(self.track) > 3, "the robot stands there")
        with self.bench.changed:
            self.track = self.track[-1:]

    def wait_for_done(self, client, what):
        # Every image of the park wakes the waiter up.
        self.bench.wait_for(lambda: client.simple_state == actionlib.SimpleGoalState.DONE, what, PATIENCE_S)
        return client.get_result()

    def test_teach_and_repeat(self):
        self.assertTrue(self.teach.wait_for_server(rospy.Duration(30.0)))
        self.assertTrue(self.repeat.wait_for_server(rospy.Duration(30.0)))
        self.place(0.0)
        self.teach.send_goal(TeachGoal(map_name="park", overwrite=True))
        self.bench.wait_for(lambda: self.teach.get_state() == actionlib.GoalStatus.ACTIVE, "teaching")
        self.driving = True
        self.bench.wait_for(lambda: self.travelled() > LENGTH_M, "the path is driven", PATIENCE_S)
        self.driving = False
        taught = list(self.track)
        self.teach.cancel_goal()
        result = self.wait_for_done(self.teach, "the map")
        self.assertTrue(result.success, result.message)
        self.assertGreater(result.distance_m, LENGTH_M - 0.5)

        self.place(START_OFFSET_M)
        self.repeat.send_goal(RepeatGoal(map_name="park", traversals=1))
        result = self.wait_for_done(self.repeat, "the path is repeated")
        self.assertTrue(result.success, result.reason)
        repeated = list(self.track)
        errors = [min(math.dist(point[:2], place[:2]) for place in taught) for point in repeated[len(repeated) // 2:]]
        rms = math.sqrt(sum(error * error for error in errors) / len(errors))
        print("cross-track error over the second half: %.3f m RMS, %.3f m at most" % (rms, max(errors)))
        self.assertLess(rms, 0.12)
        self.assertLess(math.dist(repeated[-1][:2], taught[-1][:2]), 0.6)


if __name__ == "__main__":
    rospy.init_node("cameleon_park_test")
    rostest.rosrun("perennial_nav", "cameleon_park", CameleonParkTest)
