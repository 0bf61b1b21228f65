#!/usr/bin/python3
"""The real camera driver on simulated devices: images to the byte, controls, inertial data, and every fault."""
import collections
import os
import sys
import unittest

import dynamic_reconfigure.client
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from perennial_nav.srv import InjectFault
from sensor_msgs.msg import CameraInfo, Image, Imu
from std_msgs.msg import UInt32

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from waiting import WAIT_S, Waiter  # noqa: E402

WIDTH, HEIGHT = 752, 480


class TaraTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bench = Waiter()
        cls.last = {}
        cls.counts = {}
        cls.values = {}
        cls.summary = ""
        cls.gravity = []
        cls.subscribers = [
            rospy.Subscriber("/tara/" + name, kind, cls.on_message, name, queue_size=2, buff_size=2**21)
            for name, kind in (("left/image_raw", Image), ("right/image_raw", Image), ("left/camera_info", CameraInfo),
                               ("right/camera_info", CameraInfo), ("imu", Imu), ("tara_simulator/exposure", UInt32),
                               ("tara_simulator/brightness", UInt32))]
        cls.subscribers.append(rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics))
        rospy.wait_for_service("/tara/tara_simulator/inject_fault", WAIT_S)
        cls.fault_service = rospy.ServiceProxy("/tara/tara_simulator/inject_fault", InjectFault)
        cls.reconfigure = dynamic_reconfigure.client.Client("/tara/tara_camera", timeout=WAIT_S)

    @classmethod
    def on_message(cls, message, name):
        with cls.bench.changed:
            cls.last[name] = message
            cls.counts[name] = cls.counts.get(name, 0) + 1
            if name == "imu":
                cls.gravity.append(message.linear_acceleration.z)
            cls.bench.changed.notify_all()

    @classmethod
    def on_diagnostics(cls, message):
        with cls.bench.changed:
            for status in message.status:
                if status.hardware_id == "TARA":
                    cls.values = {value.key: value.value for value in status.values}
                    cls.summary = status.message
            cls.bench.changed.notify_all()

    def setUp(self):
        self.reconfigure.update_configuration({"exposure_mode": "manual", "exposure": 8000, "brightness": 4})
        self.wait_for_images("images come")
        self.bench.wait_for(lambda: self.state("exposure") == 8000, "the exposure is set")

    def state(self, name):
        message = self.last.get("tara_simulator/" + name)
        return message.data if message else None

    def count(self, name):
        return self.counts.get(name, 0)

    def value(self, key):
        return int(float(self.values.get(key, "0")))

    def inject(self, fault, value):
        answer = self.fault_service(fault, value)
        self.assertTrue(answer.success, answer.message)

    def wait_for_images(self, what, number=5):
        begin = self.count("left/image_raw")
        self.bench.wait_for(lambda: self.count("left/image_raw") >= begin + number, what)

    def test_images_are_right_to_the_byte(self):
        # A pattern's frame may be replaced while it is read, once in a while: a whole one must come within a few.
        def is_pattern():
            left, right = self.last["left/image_raw"], self.last.get("right/image_raw")
            if right is None or left.header.stamp != right.header.stamp:
                return False
            number = left.data[0]
            columns = bytes((number + column) % 128 for column in range(WIDTH))
            rows = [bytes([(right.data[0] - row) % 128]) * WIDTH for row in range(HEIGHT)]
            return left.data == columns * HEIGHT and right.data == b"".join(rows)
        self.bench.wait_for(is_pattern, "both views are the simulator's")
        left = self.last["left/image_raw"]
        self.assertEqual((left.width, left.height, left.step, left.encoding), (WIDTH, HEIGHT, WIDTH, "mono8"))
        self.assertEqual(left.header.frame_id, "tara_left")
        self.assertEqual(self.last["right/image_raw"].header.frame_id, "tara_right")

    def test_camera_info_goes_with_the_images(self):
        self.bench.wait_for(
            lambda: "left/camera_info" in self.last and
            self.last["left/camera_info"].header.stamp == self.last["left/image_raw"].header.stamp, "equal stamps")
        info = self.last["right/camera_info"]
        self.assertEqual((info.width, info.height, info.header.frame_id), (WIDTH, HEIGHT, "tara_right"))

    def test_stamps_are_of_the_moment(self):
        begin = rospy.Time.now()
        self.wait_for_images("images come")
        stamp = self.last["left/image_raw"].header.stamp
        self.assertGreater(stamp, begin - rospy.Duration(1.0))
        self.assertLess(stamp, rospy.Time.now())

    def test_controls(self):
        self.reconfigure.update_configuration({"exposure": 4000, "brightness": 6})
        self.bench.wait_for(lambda: self.state("exposure") == 4000, "exposure")
        self.bench.wait_for(lambda: self.state("brightness") == 6, "brightness")
        self.reconfigure.update_configuration({"exposure_mode": "camera"})
        self.bench.wait_for(lambda: self.state("exposure") == 1, "the camera's automatic exposure")

    def test_software_exposure_reaches_its_target(self):
        # The pattern's mean is 63.5 at an exposure of 8000, so the target of 100 needs 12598.
        self.reconfigure.update_configuration({"exposure_mode": "software", "exposure": 2000, "target_brightness": 100.0})
        self.bench.wait_for(lambda: self.state("exposure") and abs(self.state("exposure") - 12600) < 700, "the target")

    def test_inertial_data_in_si_units(self):
        begin = self.count("imu")
        self.bench.wait_for(lambda: self.count("imu") >= begin + 20, "inertial data")
        imu = self.last["imu"]
        self.assertAlmostEqual(imu.linear_acceleration.z, 9.80665, delta=0.001)
        self.assertEqual(imu.header.frame_id, "tara_imu")
        self.assertEqual(imu.orientation_covariance[0], -1.0)
        # Another range has other units: no message may mix them up. The coarser unit shows in how gravity is rounded.
        first = len(self.gravity)
        self.reconfigure.update_configuration({"accelerometer_range": 1, "imu_rate": 2})
        self.bench.wait_for(lambda: 0.0005 < abs(self.gravity[-1] - 9.80665) < 0.001, "the other range")
        self.reconfigure.update_configuration({"accelerometer_range": 0, "imu_rate": 3})
        self.bench.wait_for(lambda: abs(self.gravity[-1] - 9.80665) < 0.0005, "the first range")
        self.assertLess(max(abs(value - 9.80665) for value in self.gravity[first:]), 0.001)

    def test_inertial_data_comes_at_its_rate(self):
        stamps = collections.deque(maxlen=100)

        def on_imu(message):
            with self.bench.changed:
                stamps.append(message.header.stamp.to_sec())
                self.bench.changed.notify_all()

        def rate():
            return (len(stamps) - 1) / (stamps[-1] - stamps[0]) if len(stamps) == stamps.maxlen else 0.0

        subscriber = rospy.Subscriber("/tara/imu", Imu, on_imu, tcp_nodelay=True)
        for code, wanted in ((4, 238.0), (2, 59.5), (3, 119.0)):
            self.reconfigure.update_configuration({"imu_rate": code})
            # Not at once: the window of the last messages has to fill, and a busy computer delays some of them.
            self.bench.wait_for(lambda w=wanted: abs(rate() / w - 1.0) < 0.1, "%.1f inertial readings a second" % wanted)
        subscriber.unregister()

    def test_diagnostics_name_the_camera(self):
        self.bench.wait_for(lambda: self.values.get("unique id") == "2560c114", "unique id")
        self.assertEqual(self.values["firmware"], "1.2.114.77")
        self.assertEqual(self.values["serial"], "SIMULATED")

    def test_survives_short_frames(self):
        short = self.value("short frames")
        self.inject("short_frames", 4)
        self.bench.wait_for(lambda: self.value("short frames") >= short + 4, "short frames are counted")
        self.wait_for_images("images go on")

    def test_survives_a_stalled_stream(self):
        stalls = self.value("stalls")
        self.inject("stalled", 1)
        self.bench.wait_for(lambda: self.value("stalls") > stalls, "the stall is noticed")
        self.inject("stalled", 0)
        self.wait_for_images("images come again")

    def test_survives_unplugging(self):
        starts = self.value("starts")
        self.inject("unplugged", 1)
        self.bench.wait_for(lambda: self.summary in ("no camera found",) or "gone" in self.summary, "it is noticed")
        self.inject("unplugged", 0)
        self.wait_for_images("images come again")
        self.bench.wait_for(lambda: self.value("starts") > starts, "started anew")
        begin = self.count("imu")
        self.bench.wait_for(lambda: self.count("imu") > begin, "inertial data comes again")

    def test_survives_a_silent_control(self):
        failures = self.value("failed requests")
        self.inject("hid_silent", 1)
        self.reconfigure.update_configuration({"exposure": 5000})
        self.wait_for_images("images go on meanwhile")
        self.bench.wait_for(lambda: self.value("failed requests") > failures, "the time-out is counted")
        begin = self.count("imu")
        self.inject("hid_silent", 0)
        self.bench.wait_for(lambda: self.count("imu") > begin + 10, "inertial data comes again, nobody having asked")
        self.reconfigure.update_configuration({"exposure": 6000})
        self.bench.wait_for(lambda: self.state("exposure") == 6000, "requests work again")

    def test_survives_nonsense_replies(self):
        bad = self.value("bad inertial reports")
        self.inject("hid_nonsense", 1)
        self.bench.wait_for(lambda: self.value("bad inertial reports") > bad + 10, "nonsense is counted")
        self.wait_for_images("images go on meanwhile")
        self.inject("hid_nonsense", 0)
        begin = self.count("imu")
        self.bench.wait_for(lambda: self.count("imu") > begin + 10, "inertial data is good again")
        self.assertAlmostEqual(self.last["imu"].linear_acceleration.z, 9.80665, delta=0.001)


if __name__ == "__main__":
    rospy.init_node("tara_test")
    rostest.rosrun("perennial_nav", "tara", TaraTest)
