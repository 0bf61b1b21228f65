#!/usr/bin/python3
"""The loop of the embedded world is taught and repeated through the drivers of the CAMELEON and of the TARA."""
import importlib.machinery
import importlib.util
import math
import os
import shutil
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray

DEMO, FOLDER = "", ""
LOOP_M = 33.0


def load(path):
    loader = importlib.machinery.SourceFileLoader("park_demo", path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("park_demo", loader))
    loader.exec_module(module)
    return module


class CameleonPark(unittest.TestCase):
    def setUp(self):
        self.demo = load(DEMO)
        self.diagnostics = {}
        self.subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics)
        self.mission = self.demo.Mission(FOLDER)
        rospy.wait_for_service("set_park")

    def on_diagnostics(self, message):
        for status in message.status:
            self.diagnostics[status.name] = {value.key: value.value for value in status.values}

    def diagnostic(self, node, key):
        values = [values[key] for name, values in self.diagnostics.items() if node in name and key in values]
        return float(values[0]) if values else 0.0

    def test_teaches_and_repeats_the_loop(self):
        taught = self.mission.teach()
        length = taught[-1, 3]
        self.assertAlmostEqual(length, LOOP_M, delta=1.0)

        finished, truth, states = self.mission.repeat("offset_start", 0.4, 6.0, self.demo.DAY, None)
        self.assertTrue(finished)
        rows = self.demo.errors(taught, truth, states)
        self.assertGreater(len(rows), 0.8 * length / 0.5 * 5, "nearly every image was registered")
        self.assertGreater(max(abs(row[1]) for row in rows), 0.3, "it did start beside the path")
        half = [row[1] for row in rows if row[0] > length / 2]
        rms = math.sqrt(sum(error * error for error in half) / len(half))
        print("cross-track error over the second half: %.3f m RMS, %.3f m at most" % (rms, max(map(abs, half))))
        self.assertLess(rms, 0.10)
        home = math.dist(truth[-1][1:3], taught[-1, :2])
        self.assertLess(home, 0.6)
        # It was the drivers that did it.
        self.mission.wait(lambda: self.diagnostic("tara_camera", "images") > len(truth), "the camera's diagnostics")
        self.mission.wait(lambda: self.diagnostic("cameleon_driver", "statuses") > len(truth), "the robot's diagnostics")


if __name__ == "__main__":
    DEMO, FOLDER = rospy.myargv()[1:3]
    shutil.rmtree(os.path.join(FOLDER, "maps"), ignore_errors=True)
    rospy.init_node("cameleon_park_test")
    rostest.rosrun("perennial_nav", "cameleon_park", CameleonPark, sys.argv)
