#!/usr/bin/env python3
"""Bad parameters stop a node at start-up and are named; the shipped ones load."""
import glob
import os
import signal
import subprocess
import sys
import unittest

import rosnode
import rospkg
import rospy
import rostest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from fake_robot import wait_until  # noqa: E402


def start(node, name, *arguments):
    return subprocess.Popen(
        ["rosrun", "perennial_nav", node, "__name:=" + name] + list(arguments),
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
    )  # fmt: skip


NODES = {
    "map_manager": "map_manager",
    "park": "park_simulator",
    "repeat_navigator": "repeat_navigator",
    "teach_recorder": "teach_recorder",
}
LOADED_ELSEWHERE = {"cameleon", "cameleon_video", "tara", "teleop"}  # by the tests of the drivers


class Parameters(unittest.TestCase):
    def refused(self, node, *arguments):
        """The node must end by itself; returns what it said."""
        name = node.replace("_node", "") + "_refused"
        rospy.set_param(name, {})
        process = start(node, name, *arguments)
        output, _ = process.communicate(timeout=60)
        self.assertNotEqual(process.returncode, 0, output)
        return output

    def test_unknown_strategy_lists_those_that_exist(self):
        output = self.refused("map_manager_node", "_map_folder:=/tmp", "_strategy:=photographic")
        self.assertIn("photographic", output)
        for name in ("static", "latest", "score_based"):
            self.assertIn(name, output)

    def test_parameter_out_of_range(self):
        output = self.refused("repeat_navigator_node", "_registration/ratio:=1.5")
        self.assertIn("/registration/ratio", output)
        self.assertIn("[0, 1]", output)

    def test_parameter_of_the_wrong_type(self):
        output = self.refused("repeat_navigator_node", "_registration/min_inliers:=many")
        self.assertIn("/registration/min_inliers must be an integer", output)

    def test_unknown_parameter(self):
        output = self.refused("teach_recorder_node", "_map_folder:=/tmp", "_teaching/map_intervall_m:=0.2")
        self.assertIn("unknown parameter", output)
        self.assertIn("/teaching/map_intervall_m", output)
        self.assertIn("map_interval_m", output.replace("map_intervall_m", ""))

    def test_unknown_group(self):
        output = self.refused("repeat_navigator_node", "_steerng/gain_per_rad:=1.0")
        self.assertIn("/steerng", output)

    def test_parameter_of_a_strategy(self):
        output = self.refused(
            "map_manager_node", "_map_folder:=/tmp", "_strategy:=score_based", "_score_based/exchange:=2.0"
        )
        self.assertIn("/score_based/exchange", output)
        self.assertIn("[0, 1]", output)

    def test_missing_map_folder(self):
        self.assertIn("map_folder", self.refused("teach_recorder_node"))

    def test_a_navigator_without_any_parameter(self):
        """As respawn starts it after the master was restarted: without the dead man's switch that was configured."""
        output = self.refused("repeat_navigator_node")
        self.assertIn("none of the parameters of /repeat_navigator_refused is set", output)

    def test_shipped_configurations_load(self):
        folder = os.path.join(rospkg.RosPack().get_path("perennial_nav"), "config")
        names = [os.path.splitext(os.path.basename(file))[0] for file in glob.glob(os.path.join(folder, "*.yaml"))]
        self.assertEqual(set(names), set(NODES) | LOADED_ELSEWHERE, "a configuration that no test loads")
        for name, node in NODES.items():
            file = os.path.join(folder, name + ".yaml")
            subprocess.check_call(["rosparam", "load", file, node])
            process = start(node + "_node", node, *([] if name in ("park", "repeat_navigator") else ["_map_folder:=/tmp"]))
            try:
                wait_until(
                    lambda: "/" + node in rosnode.get_node_names() or process.poll() is not None, "node " + node
                )
                wait_until(lambda: self.serves(node) or process.poll() is not None, node + " to be ready")
                self.assertIsNone(process.poll(), "%s does not run with %s" % (node, file))
            finally:
                process.send_signal(signal.SIGINT)
                process.communicate()

    @staticmethod
    def serves(node):
        """Every node offers something of its own when it is up."""
        publications = [topic for topic, nodes in rospy.get_master().getSystemState()[2][0] if "/" + node in nodes]
        return "/diagnostics" in publications


if __name__ == "__main__":
    rospy.init_node("parameters_test")
    rostest.rosrun("perennial_nav", "parameters", Parameters, sys.argv)
