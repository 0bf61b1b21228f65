#!/usr/bin/env python3
"""A ROS master that dies and comes back while the robot repeats: the robot stops, and the nodes end to be started anew."""
import os
import shutil
import socket
import subprocess
import sys
import unittest

import rospkg
import rospy
import rosgraph
import rostest
import yaml

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from fake_robot import wait_until  # noqa: E402

FOLDER = ""  # of the maps; from the command line


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


class MasterRestart(unittest.TestCase):
    processes = []

    @classmethod
    def start(cls, *command):
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        cls.processes.append(process)
        return process

    @classmethod
    def start_master(cls):
        master = cls.start("rosmaster", "--core", "-p", os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1])
        wait_until(rosgraph.is_master_online, "the master")
        return master

    @classmethod
    def start_node(cls, name, **parameters):
        folder = os.path.join(rospkg.RosPack().get_path("perennial_nav"), "config")
        with open(os.path.join(folder, name + ".yaml")) as file:
            loaded = yaml.safe_load(file)
        loaded.update(parameters)
        rosgraph.Master("/master_restart_test").setParam("/" + name, loaded)
        return cls.start("rosrun", "perennial_nav", name + "_node", "image:=/camera/image_raw", "__name:=" + name)

    @classmethod
    def setUpClass(cls):
        os.environ["ROS_MASTER_URI"] = "http://127.0.0.1:%d" % free_port()
        cls.master = cls.start_master()
        rosgraph.Master("/master_restart_test").setParam("/use_sim_time", True)
        cls.nodes = [
            cls.start_node("teach_recorder", map_folder=FOLDER),
            cls.start_node("map_manager", map_folder=FOLDER),
            cls.start_node("repeat_navigator"),
        ]
        rospy.init_node("master_restart_test")
        from stack import LENGTH_M, Stack  # needs the node

        cls.length_m = LENGTH_M
        cls.stack = Stack()
        result = cls.stack.teach_path("path")
        assert result.success, result.message

    @classmethod
    def tearDownClass(cls):
        for process in cls.processes:
            if process.poll() is None:
                process.kill()
                process.wait()
            process.stdout.close()

    def test_stops_and_starts_anew(self):
        robot = self.stack.robot
        self.stack.begin_repeat("path")
        self.stack.drive(lambda: robot.x > 1.0)
        self.assertGreater(robot.command().linear.x, 0.1)
        self.master.kill()
        self.master.communicate()

        def told():
            robot.speed = robot.command().linear.x / 20.0  # time goes on slowly, or the path would end before
            robot.step(["repeat_navigator"])
            rospy.rostime.wallsleep(0.05)
            return "master does not answer" in self.stack.states[-1].reason

        wait_until(told, "the navigator to notice that the master is gone")
        wait_until(robot.stands, "the robot to stop")
        self.assertFalse(self.stack.done(self.stack.repeat), "it would go on if the same master answered again")
        self.start_master()
        for node in self.nodes:
            output, _ = node.communicate(timeout=60)
            self.assertEqual(node.returncode, 1, output)
            self.assertIn("the ROS master was restarted", output)


if __name__ == "__main__":
    FOLDER = rospy.myargv()[1]
    shutil.rmtree(FOLDER, ignore_errors=True)
    try:
        rostest.rosrun("perennial_nav", "master_restart", MasterRestart, sys.argv)
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)
