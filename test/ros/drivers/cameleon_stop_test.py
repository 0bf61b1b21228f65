#!/usr/bin/python3
"""The robot stops when its driver ends, whichever way, and when the ROS master is gone."""
import os
import signal
import socket
import subprocess
import sys
import unittest

import roslib.packages
import rospy
import rostest
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from robot_bench import RobotBench  # noqa: E402

WATCHDOG_S = 0.84  # the robot's own
REACTION_S = 0.4
MASTER_TIMEOUT_S = 1.0
DEFAULT_LIMIT_MPS = 0.5


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def listens(port):
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


class CameleonStopTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bench = RobotBench()
        cls.binary = roslib.packages.find_node("perennial_nav", "cameleon_driver_node")[0]

    def setUp(self):
        self.processes = []

    def tearDown(self):
        self.bench.release()
        for process in self.processes:
            if process.poll() is None:
                process.kill()
            process.wait()
        self.bench.wait_until_still()

    def start(self, command, **environment):
        process = subprocess.Popen(command, env=dict(os.environ, **environment))
        self.processes.append(process)
        return process

    def start_driver(self, *arguments, **environment):
        return self.start([self.binary, "__name:=cameleon_driver", "_robot_host:=127.0.0.1", "_robot_port:=50115",
                           "_master_timeout_s:=%f" % MASTER_TIMEOUT_S, *arguments], **environment)

    def stopping_time(self, begin):
        self.bench.wait_until_still()
        return self.bench.first_still_after(begin) - begin

    def end_driver(self, how):
        driver = self.start_driver()
        self.bench.drive(0.3)
        self.bench.wait_until_moving()
        begin = self.bench.now()
        driver.send_signal(how)
        took = self.stopping_time(begin)
        driver.wait(10.0)
        still = self.bench.now()
        self.bench.wait_loops(10)
        self.assertFalse(self.bench.moved_since(still))
        return took, driver.returncode

    def test_stops_on_ctrl_c(self):
        took, status = self.end_driver(signal.SIGINT)
        self.assertEqual(status, 0)
        self.assertLess(took, 0.1 + REACTION_S)

    def test_stops_on_termination(self):
        took, status = self.end_driver(signal.SIGTERM)
        self.assertEqual(status, 0)
        self.assertLess(took, 0.1 + REACTION_S)

    def test_the_robot_stops_itself_when_the_driver_is_killed(self):
        took, _ = self.end_driver(signal.SIGKILL)
        self.assertLess(took, WATCHDOG_S + REACTION_S)

    def start_master(self, port):
        """A second master: the simulated robot is not concerned by what becomes of it."""
        master = self.start(["rosmaster", "--core", "-p", str(port)])
        self.bench.wait_for(lambda: listens(port), "the second master is up")
        return master

    def start_commander(self, forward, uri):
        command = "{linear: {x: %f}, angular: {z: 0.0}}" % forward
        self.start(["rostopic", "pub", "-r", "20", "cmd_vel", "geometry_msgs/Twist", command], ROS_MASTER_URI=uri)

    def test_stops_when_the_master_is_gone(self):
        port = free_port()
        uri = "http://127.0.0.1:%d" % port
        core = self.start_master(port)
        self.start_driver(ROS_MASTER_URI=uri)
        self.start_commander(0.3, uri)
        self.bench.wait_until_moving()
        begin = self.bench.now()
        core.kill()
        core.wait(20.0)
        gone = self.bench.now()
        took = self.stopping_time(begin)
        self.assertLess(took, (gone - begin) + MASTER_TIMEOUT_S + REACTION_S)
        still = self.bench.now()
        self.bench.wait_loops(25)  # the commander goes on: the connection of its topic does not need the master
        self.assertFalse(self.bench.moved_since(still))

    def test_stands_until_commanded_when_the_master_was_restarted(self):
        port = free_port()
        uri = "http://127.0.0.1:%d" % port
        master = self.start_master(port)
        driver = self.start_driver(ROS_MASTER_URI=uri)
        self.start_commander(0.3, uri)
        self.bench.wait_until_moving()
        master.kill()
        master.wait(20.0)
        self.start_master(port)
        self.assertEqual(driver.wait(60.0), 1, "the new master does not know it")
        still = self.bench.wait_until_still()
        # By its defaults but for the robot's address: all other parameters went with the old master.
        self.start([self.binary, "__name:=cameleon_driver", "_robot_host:=127.0.0.1", "_robot_port:=50115"],
                   ROS_MASTER_URI=uri)
        listener = self.start(["rostopic", "echo", "-n", "5", "odom"], ROS_MASTER_URI=uri, PYTHONUNBUFFERED="1")
        self.assertEqual(listener.wait(60.0), 0)
        self.bench.wait_loops(25)
        self.assertFalse(self.bench.moved_since(still), "the old commander cannot reach the new driver")
        self.start_commander(3.0, uri)
        self.bench.wait_for(lambda: self.bench.states[-1][1] == DEFAULT_LIMIT_MPS, "the robot to drive as fast as it may")

    def test_a_latched_emergency_stop_holds_a_driver_that_starts_later(self):
        stop = rospy.Publisher("emergency_stop", Bool, queue_size=1, latch=True)
        stop.publish(True)
        odometry = []
        subscriber = rospy.Subscriber("odom", Odometry, lambda message: (odometry.append(message), self.bench.notify()))
        self.start_driver()
        self.bench.wait_for(lambda: len(odometry) > 10 and stop.get_num_connections() > 0, "the driver is connected")
        begin = self.bench.now()
        self.bench.drive(0.3)
        self.bench.wait_loops(40)
        self.assertFalse(self.bench.moved_since(begin))
        stop.publish(False)
        self.bench.wait_until_moving("a fresh command moves it once the stop is cleared")
        stop.unregister()
        subscriber.unregister()

    def test_broadcasts_transforms_only_where_they_are_wanted(self):
        for wanted in (False, True):
            transforms, poses = [], []
            subscribers = [rospy.Subscriber("/tf", TFMessage, transforms.append),
                           rospy.Subscriber("/odom", Odometry, poses.append)]
            driver = self.start_driver("_publish_tf:=%s" % str(wanted).lower())
            self.bench.wait_for(lambda: subscribers[0].get_num_connections() > 0, "the driver's transforms")
            self.bench.wait_for(lambda: len(poses) > 50, "odometry")
            if wanted:
                self.bench.wait_for(lambda: transforms, "transforms")
            else:
                self.assertEqual(transforms, [])
            driver.terminate()
            driver.wait(10.0)
            for subscriber in subscribers:
                subscriber.unregister()

    def test_refuses_wrong_parameters(self):
        for index, (key, value) in enumerate((("max_forward_mps", -1), ("no_such_parameter", 1), ("robot_port", 70000))):
            # Parameters stay on the server: each driver needs a name of its own.
            driver = subprocess.run([self.binary, "__name:=refused_%d" % index, "_%s:=%s" % (key, value)],
                                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=20.0, check=False)
            self.assertEqual(driver.returncode, 1, key)
            self.assertIn(key, driver.stdout.decode())


if __name__ == "__main__":
    rospy.init_node("cameleon_stop_test")
    rostest.rosrun("perennial_nav", "cameleon_stop", CameleonStopTest)
