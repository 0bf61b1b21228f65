"""What the tests of the robot's driver share: the simulator's view of the robot, and waiting for conditions."""
import math

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from perennial_nav.srv import InjectFault
from waiting import WAIT_S, Waiter


class RobotBench(Waiter):
    """Commands the robot once per loop of the simulator, and records what the simulator says it does."""

    def __init__(self, command_topic="cmd_vel"):
        super().__init__()
        self.states = []  # (time of the simulator in s, forward, turn, x, y, yaw)
        self.commands = None  # (forward, turn, flipper) to be sent, or None
        self.sent_last_s = 0.0  # time of the simulator when a command was sent last
        self.publisher = rospy.Publisher(command_topic, Twist, queue_size=1, tcp_nodelay=True)
        self.subscriber = rospy.Subscriber("cameleon_simulator/state", Odometry, self.on_state, tcp_nodelay=True)
        rospy.wait_for_service("cameleon_simulator/inject_fault", WAIT_S)
        self.fault_service = rospy.ServiceProxy("cameleon_simulator/inject_fault", InjectFault)

    def on_state(self, message):
        now = message.header.stamp.to_sec()
        twist = message.twist.twist
        position = message.pose.pose.position
        with self.changed:
            self.states.append((now, twist.linear.x, twist.angular.z, position.x, position.y, yaw_of(message)))
            if self.commands is not None:
                self.sent_last_s = now
            command = self.commands
            self.changed.notify_all()
        if command is not None:
            self.publisher.publish(twist_of(*command))

    def drive(self, forward, turn=0.0, flipper=0.0):
        with self.changed:
            self.commands = (forward, turn, flipper)

    def release(self):
        """Sends no more commands. Returns when the last one was sent."""
        with self.changed:
            self.commands = None
            return self.sent_last_s

    def now(self):
        with self.changed:
            return self.states[-1][0]

    def is_moving(self):
        return bool(self.states) and self.states[-1][1:3] != (0.0, 0.0)

    def wait_until_moving(self, what="the robot moves"):
        self.wait_for(self.is_moving, what)

    def wait_until_still(self, what="the robot stands still"):
        self.wait_for(lambda: not self.is_moving(), what)
        return self.now()

    def wait_loops(self, loops):
        """Lets the simulator do so many loops: its own time, however long that takes."""
        begin = len(self.states)
        self.wait_for(lambda: len(self.states) >= begin + loops, "the simulator runs")

    def moved_since(self, time_s):
        with self.changed:
            return any(state[1:3] != (0.0, 0.0) for state in self.states if state[0] > time_s)

    def first_still_after(self, time_s):
        with self.changed:
            return next(state[0] for state in self.states if state[0] > time_s and state[1:3] == (0.0, 0.0))

    def inject(self, fault, value):
        answer = self.fault_service(fault, value)
        assert answer.success, answer.message


def yaw_of(odometry):
    orientation = odometry.pose.pose.orientation
    return 2.0 * math.atan2(orientation.z, orientation.w)


def twist_of(forward, turn, flipper):
    twist = Twist()
    twist.angular.y = flipper
    twist.linear.x = forward
    twist.angular.z = turn
    return twist
