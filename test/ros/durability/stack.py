"""Real nodes that a test starts, kills and starts again, driven by the fake robot; and what a map file holds."""
import hashlib
import os
import signal
import sqlite3
import struct
import subprocess
import sys
import time
import zlib

import actionlib
import roslib.packages
import rospy
from actionlib_msgs.msg import GoalStatus
from perennial_nav.msg import RepeatAction, RepeatGoal, TeachAction, TeachGoal

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from fake_robot import FakeRobot, wait_until  # noqa: E402

LENGTH_M = 4.0
SPEED_MPS = 1.0


def program(name):
    return roslib.packages.find_node("perennial_nav", name)[0]


class Node:
    """A node in a process of its own. Parameters come from the server, where the .test file puts them."""

    def __init__(self, name, environment=None, arguments=()):
        self.name = name
        self.environment = environment or {}
        self.arguments = list(arguments)
        self.process = None

    def start(self):
        command = [program(self.name.rstrip("_0123456789") + "_node"), "__name:=" + self.name,
                   "image:=/camera/image_raw"] + self.arguments
        self.process = subprocess.Popen(command, env=dict(os.environ, **self.environment))

    def is_dead(self):
        return self.process is None or self.process.poll() is not None

    def kill(self, how=signal.SIGKILL):
        if not self.is_dead():
            self.process.send_signal(how)
            self.process.wait(30.0)


class MapContent:
    """What is committed in a map file, read past the package's own code."""

    def __init__(self, file):
        with sqlite3.connect("file:%s?mode=ro" % file, uri=True) as database:
            self.traversals = database.execute("SELECT traversal, updated_maps FROM traversal ORDER BY 1").fetchall()
            self.states = database.execute("SELECT local_map, traversal, crc FROM state ORDER BY 2, 1").fetchall()
            self.version = database.execute("PRAGMA user_version").fetchone()[0]
            self.places = database.execute("SELECT count(*) FROM local_map").fetchone()[0]
        database.close()

    def upto(self, traversal):
        """A fingerprint of everything up to this traversal."""
        states = [state for state in self.states if state[1] <= traversal]
        traversals = [row for row in self.traversals if row[0] <= traversal]
        return hashlib.sha256(repr((self.places, states, traversals)).encode()).hexdigest()

    def newest(self):
        return self.traversals[-1][0]

    def is_whole(self):
        """Every traversal has as many states as it says it has; the teaching one for each place."""
        counts = {}
        for _, traversal, _ in self.states:
            counts[traversal] = counts.get(traversal, 0) + 1
        return counts == dict(self.traversals) and counts[0] == self.places


def make_format_1(file):
    """A map as the last program of format version 1 wrote it: of a default teaching, only the version differs."""
    with open(file, "r+b") as stream:
        page = bytearray(stream.read(4092))
        page[60:64] = struct.pack(">I", 1)
        stream.seek(0)
        stream.write(page + struct.pack("<I", zlib.crc32(struct.pack("<I", 1) + page)))


def verify(file):
    """What map_tool finds wrong; it also undoes what a crash interrupted, as every opening does."""
    result = subprocess.run([program("map_tool"), "verify", file], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    return "" if result.returncode == 0 else result.stdout.decode()


class Stack:
    def __init__(self, nodes):
        self.robot = FakeRobot()
        self.nodes = {node.name: node for node in nodes}
        self.teach = actionlib.SimpleActionClient("teach", TeachAction)
        self.repeat = actionlib.SimpleActionClient("repeat", RepeatAction)

    def start(self):
        """Starts what is dead, and waits until it answers."""
        for node in self.nodes.values():
            if node.is_dead():
                node.start()
        wait_until(lambda: self.tick() and self.robot.images.get_num_connections() >= 2, "subscribers of the images")
        wait_until(lambda: self.tick() and self.robot.odometry.get_num_connections() >= 2, "subscribers of odometry")
        for client in (self.teach, self.repeat):
            wait_until(lambda: self.tick() and self.is_connected(client), "an action server")
        rospy.wait_for_service("begin_traversal", 60.0)

    def stop(self):
        for node in self.nodes.values():
            node.kill(signal.SIGINT)

    def tick(self):
        self.robot.tick(0.05)
        return True

    @staticmethod
    def is_connected(client):
        """Connected to the server that runs now, not to one that was killed."""
        return client.wait_for_server(rospy.Duration(0.01)) and client.action_client.pub_goal.get_num_connections() > 0

    @staticmethod
    def is_done(client):
        return client.simple_state == actionlib.SimpleGoalState.DONE

    def step(self, victim=None):
        """One image; returns when both nodes are done with it, or the victim is dead."""
        stamp = self.robot.step()
        for name in ("teach_recorder", "repeat_navigator"):
            answer = (name, stamp.to_nsec())
            wait_until(lambda: self.robot.has_answer(answer) or (victim and victim.is_dead()), name)

    def begin(self, client, goal, victim=None):
        self.robot.restart()
        client.send_goal(goal)
        wait_until(lambda: self.is_done(client) or client.get_state() == GoalStatus.ACTIVE or (victim and victim.is_dead()),
                   "the goal to be taken up")

    def teach_path(self, name, victim=None, after_step=lambda i: None):
        """Teaches LENGTH_M; returns the result, or None when the victim died."""
        self.begin(self.teach, TeachGoal(map_name=name, overwrite=True), victim)
        self.robot.speed = SPEED_MPS
        self.robot.x = -SPEED_MPS * 0.1  # the first image is taken at 0
        for i in range(int(LENGTH_M / SPEED_MPS / 0.1) + 1):
            self.step(victim)
            after_step(i)
            if victim and victim.is_dead():
                return None
        self.teach.cancel_goal()
        return self.result(self.teach, victim)

    def repeat_path(self, name, victim=None, after_step=lambda i: None, traversals=1):
        """Repeats the path; returns the result, or None when the victim died."""
        self.begin(self.repeat, RepeatGoal(map_name=name, traversals=traversals), victim)
        self.robot.loop_m = LENGTH_M
        for i in range(1000):
            if self.is_done(self.repeat) or (victim and victim.is_dead()):
                break
            self.step(victim)
            after_step(i)
        return self.result(self.repeat, victim)

    def result(self, client, victim=None):
        begin = time.monotonic()

        def over():
            if time.monotonic() - begin > 5.0:
                self.tick()  # somebody may wait for time to go on
            return self.is_done(client) or (victim and victim.is_dead())

        wait_until(over, "the result")
        return client.get_result() if self.is_done(client) else None
