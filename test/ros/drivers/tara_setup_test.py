#!/usr/bin/python3
"""The camera's driver finds its camera as it is told, publishes the calibration that it is given, and costs little.

The cost alone, printed: rostest --text perennial_nav tara_setup.test
"""
import glob
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import roslib.packages
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from sensor_msgs.msg import CameraInfo

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from waiting import WAIT_S, Waiter  # noqa: E402

FOLDER = ""
PRELOAD_FIRST = os.environ.get("PERENNIAL_PRELOAD_FIRST", "")  # a sanitizer's runtime: scripts/check
RATE = 60
LARGEST_SHARE = 0.05  # of one core, with RATE images a second
CALIBRATION = """image_width: %d
image_height: %d
camera_name: tara_left
camera_matrix: {rows: 3, cols: 3, data: [714.4, 0, 376, 0, 714.4, 240, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [-0.4, 0.2, 0, 0, 0]}
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
projection_matrix: {rows: 3, cols: 4, data: [746.6, 0, 376, 0, 0, 746.6, 240, 0, 0, 0, 1, 0]}
"""


class TaraSetupTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.binary = roslib.packages.find_node("perennial_nav", "tara_camera_node")[0]
        cls.bench = Waiter()
        rospy.wait_for_service("/tara/tara_simulator/inject_fault", WAIT_S)  # its devices are there by then

    def setUp(self):
        self.infos = []
        self.values = {}
        self.summary = ""
        self.processes = []
        self.scratch = tempfile.mkdtemp(prefix="perennial_tara_calibration_")

    def tearDown(self):
        for process in self.processes:
            process.terminate()
        for process in self.processes:
            process.wait(20.0)
        shutil.rmtree(self.scratch)

    def start(self, name, **parameters):
        """A driver of this name, in a namespace of this name; what it says is kept."""
        settings = dict({"sysfs_root": os.path.join(FOLDER, "sys"), "dev_root": os.path.join(FOLDER, "dev"),
                         "retry_period_s": 0.2}, **parameters)
        environment = dict(os.environ, LD_PRELOAD=PRELOAD_FIRST + "libperennial_tara_preload.so", TARA_SIMULATION=FOLDER,
                           ROS_NAMESPACE="/" + name)
        self.processes.append(subprocess.Popen(
            [self.binary, "__name:=" + name] + ["_%s:=%s" % item for item in settings.items()], env=environment))
        self.subscribers = [rospy.Subscriber("/%s/left/camera_info" % name, CameraInfo, self.on_info),
                            rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics, name)]

    def on_info(self, message):
        with self.bench.changed:
            self.infos.append(message)
            self.bench.changed.notify_all()

    def on_diagnostics(self, message, name):
        with self.bench.changed:
            for status in message.status:
                if status.name.endswith(name + ": camera"):
                    self.values = {value.key: value.value for value in status.values}
                    self.summary = status.message
            self.bench.changed.notify_all()

    def wait_for_images(self, number, what):
        begin = len(self.infos)
        self.bench.wait_for(lambda: len(self.infos) >= begin + number, what, 3 * WAIT_S)

    def test_finds_its_camera(self):
        for name, wanted in (("by_serial", {"serial": "SIMULATED"}), ("by_unique_id", {"serial": "2560c114"}),
                             ("by_path", {"video_device": os.path.join(FOLDER, "dev", "video0")})):
            self.start(name, **wanted)
            self.wait_for_images(3, name)

    def test_leaves_other_cameras_alone(self):
        for name, wanted in (("other_serial", {"serial": "OTHER"}),
                             ("other_path", {"video_device": os.path.join(FOLDER, "dev", "video1")})):
            self.start(name, **wanted)
            self.bench.wait_for(lambda: self.summary == "no camera found", name)
            self.assertEqual(self.infos, [])
            self.summary = ""

    def write_calibration(self, width, height):
        path = os.path.join(self.scratch, "left.yaml")
        with open(path, "w") as file:
            file.write(CALIBRATION % (width, height))
        return "file://" + path

    def test_publishes_its_calibration(self):
        self.start("calibrated", left_info_url=self.write_calibration(752, 480))
        self.wait_for_images(3, "images come")
        info = self.infos[-1]
        self.assertEqual((info.width, info.height, info.distortion_model), (752, 480, "plumb_bob"))
        self.assertEqual((info.K[0], info.K[2], info.P[0], info.D[0]), (714.4, 376.0, 746.6, -0.4))

    def test_a_calibration_for_another_size_is_not_published(self):
        self.start("wrongly_calibrated", left_info_url=self.write_calibration(640, 480))
        self.wait_for_images(3, "images come")
        info = self.infos[-1]
        self.assertEqual((info.width, info.height, info.K[0]), (752, 480, 0.0))

    def processor_time_s(self):
        """Of the driver's own threads: those of the simulated camera live in its process, too, and have names."""
        total_ns = 0
        for task in glob.glob("/proc/%d/task/*" % self.processes[-1].pid):
            with open(task + "/comm") as comm, open(task + "/schedstat") as times:
                if not comm.read().startswith("simulated"):
                    total_ns += int(times.read().split()[0])
        return 1e-9 * total_ns

    def share_of_a_core(self):
        self.wait_for_images(RATE, "images come")
        before_s, first = self.processor_time_s(), len(self.infos)
        self.wait_for_images(4 * RATE, "many images come")
        return RATE * (self.processor_time_s() - before_s) / (len(self.infos) - first)

    @unittest.skipIf(PRELOAD_FIRST, "with a sanitizer it costs more")
    def test_costs_little(self):
        """Processor time per image, so that it does not matter what else this computer does."""
        self.start("costs", frame_rate=RATE)
        alone = self.share_of_a_core()
        self.subscribers += [rospy.Subscriber("/costs/%s/image_raw" % view, rospy.AnyMsg, lambda _: None, buff_size=2**21)
                             for view in ("left", "right")]
        sending = self.share_of_a_core()
        print("tara_camera_node at %d images/s: %.1f %% of a core, %.1f %% with both views sent to another process"
              % (RATE, 100.0 * alone, 100.0 * sending))
        self.assertLess(alone, LARGEST_SHARE)


if __name__ == "__main__":
    FOLDER = rospy.myargv()[1]
    rospy.init_node("tara_setup_test")
    rostest.rosrun("perennial_nav", "tara_setup", TaraSetupTest, sys.argv)
