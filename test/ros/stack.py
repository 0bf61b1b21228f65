"""The nodes' side of tests with a fake robot: teaching and repeating a straight path through the real nodes."""
import actionlib
import rospy
from fake_robot import FakeRobot, wait_until
from perennial_nav.msg import NavigationState, Registration, RepeatAction, RepeatGoal, TeachAction, TeachGoal

LENGTH_M = 8.0
BOTH = ["teach_recorder", "repeat_navigator"]
UNANSWERED = (actionlib.CommState.WAITING_FOR_GOAL_ACK, actionlib.CommState.PENDING)


class Stack:
    """Shared by the tests of a file: starting nodes takes longer than the tests."""

    def __init__(self, robot=None):
        self.robot = robot or FakeRobot()
        self.registrations, self.states = [], []
        rospy.Subscriber("registration", Registration, self.registrations.append, queue_size=1000)
        rospy.Subscriber("navigation_state", NavigationState, self.states.append, queue_size=1000)
        self.teach = actionlib.SimpleActionClient("teach", TeachAction)
        self.repeat = actionlib.SimpleActionClient("repeat", RepeatAction)
        self.robot.connect(nodes=2)
        wait_until(lambda: self.teach.wait_for_server(rospy.Duration(0.01)) or self.tick(), "teach")
        wait_until(lambda: self.repeat.wait_for_server(rospy.Duration(0.01)) or self.tick(), "repeat")

    def tick(self):
        self.robot.tick(0.1)
        return False

    @staticmethod
    def done(client):
        # Its own state is no help: the thread that ends the last goal may set it when the next one has been sent already.
        return client.gh is None or client.gh.get_result() is not None

    def end(self, client):
        """Ends a goal, by its name: cancelling all goals may arrive late, and end the next one."""
        if not self.done(client):
            client.cancel_goal()
        wait_until(lambda: self.done(client), "the end of the goal")

    def start(self, client, goal):
        client.send_goal(goal)
        wait_until(
            lambda: self.done(client) or client.gh.get_comm_state() not in UNANSWERED, "the goal to be taken up"
        )

    def result(self, client):
        wait_until(lambda: self.done(client), "the result")
        return client.get_result()

    def teach_path(self, name, overwrite=False, length_m=LENGTH_M, speed=0.5):
        robot = self.robot
        self.settle()
        self.start(self.teach, TeachGoal(map_name=name, overwrite=overwrite))
        if self.done(self.teach):
            return self.result(self.teach)
        robot.speed = speed
        robot.x -= robot.speed * 0.1  # the first image is taken at 0
        while robot.x < length_m - 1e-6:
            robot.step(BOTH)
        self.teach.cancel_goal()
        return self.result(self.teach)

    def settle(self, x=0.0):
        """Puts the robot somewhere else, and waits until nothing from before is on its way any more."""
        self.robot.restart(x)
        self.robot.speed = 0.0
        for _ in range(2):
            self.robot.step(BOTH)
        self.robot.speed = None

    def begin_repeat(self, name, **goal):
        self.settle(goal.get("start_distance_m", 0.0))
        del self.registrations[:]
        self.start(self.repeat, RepeatGoal(map_name=name, **goal))

    def drive(self, until):
        for _ in range(1000):
            if self.done(self.repeat) or until():
                return
            self.robot.step(BOTH)
        raise AssertionError("the robot drove on and on")
