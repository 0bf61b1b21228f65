#!/usr/bin/env python3
"""Driver, robot, camera, joystick node and whoever sent the goal are killed while the robot repeats: it stops at once, and the
repeat ends with a reason or goes on, never unguided."""
import os
import shutil
import subprocess
import sys

import roslib.packages
import rospy
import rostest
from perennial_nav.msg import NavigationState
from sensor_msgs.msg import Joy

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from fake_robot import wait_until  # noqa: E402
from killing import kill, wait_for_new  # noqa: E402
from real_time import PATH_M, STOP_S, RealTimeTest, Robot  # noqa: E402

FOLDER = ""  # of the maps; from the command line


class Killed(RealTimeTest):
    @classmethod
    def setUpClass(cls):
        cls.begin(Robot())
        cls.joystick = rospy.Publisher("/joy", Joy, queue_size=1)
        cls.processes = []

    @classmethod
    def tearDownClass(cls):
        for process in cls.processes:
            if process.poll() is None:
                process.terminate()
            process.wait()

    @classmethod
    def start_program(cls, name, *arguments):
        cls.processes.append(subprocess.Popen([roslib.packages.find_node("perennial_nav", name)[0], *arguments]))
        return cls.processes[-1]

    def states_of(self, state, reason):
        return [told for told in self.stack.states if told.state == state and reason in told.reason]

    def test_driver(self):
        """The new one counts the way from 0 again: nobody knows how far the robot rolled meanwhile."""
        self.drive_to(1.0)
        mark = self.robot.mark()
        killed = kill("/cameleon_driver")
        still = self.assert_stops(mark)
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn("started anew", result.reason)
        wait_for_new("/cameleon_driver", killed)
        self.assert_stood(still)
        self.assert_guided()
        self.repeat()
        self.assert_succeeds()

    def test_robot(self):
        """Its odometers start from 0; the driver goes on from where it was."""
        self.drive_to(1.0)
        mark = self.robot.mark()
        killed = kill("/cameleon_simulator")
        wait_for_new("/cameleon_simulator", killed)
        wait_until(lambda: self.robot.newest().simulator_s < self.robot.states[mark - 1].simulator_s, "the robot")
        self.assert_succeeds()
        self.assert_guided()
        states = self.robot.since(mark - 1)
        back = next(i for i in range(1, len(states)) if states[i].simulator_s < states[i - 1].simulator_s)
        first = next(i for i in range(back, len(states)) if states[i].moving)
        print("%s: stood for %.2f s before it drove again" % (self.id(), states[first].simulator_s))
        self.assertGreater(first, back, "it stands until the driver has it again")
        self.assertAlmostEqual(states[first - 1].x, states[back].x, places=6)

    def test_camera(self):
        """The new one may be there within the navigator's time-out, or the robot stands meanwhile."""
        self.drive_to(1.0)
        mark = self.robot.mark()
        killed = kill("/tara/tara_camera")
        wait_for_new("/tara/tara_camera", killed)
        self.assert_succeeds()
        self.assert_guided()
        dark_s, before_s, after_s = self.longest_gap(self.robot.since(mark)[0].stamp_s)
        stood = [s for s in self.robot.since(mark) if before_s < s.stamp_s < after_s and not s.moving]
        print("%s: no image for %.2f s, stood: %s" % (self.id(), dark_s, bool(stood)))
        self.assertTrue(stood or dark_s < STOP_S, "without images it stands")

    def longest_gap(self, from_s):
        """Between images that the navigator was done with: its length, beginning and end."""
        stamps = sorted(stamp for stamp in self.seen if stamp > from_s - 1.0)
        return max((after - before, before, after) for before, after in zip(stamps, stamps[1:]))

    def test_cameras_world(self):
        """The camera goes on, but there is nothing that it could see, as with a cable that was pulled."""
        self.drive_to(1.0)
        mark = self.robot.mark()
        kill("/tara/tara_simulator")
        still = self.assert_stops(mark)
        result = self.stack.result(self.stack.repeat)
        self.assertFalse(result.success)
        self.assertIn("no image", result.reason)
        self.assert_stood(still)
        self.assert_guided()
        self.start_program("tara_simulator_node", "__ns:=tara", "__name:=tara_simulator", "image:=/camera/image_raw")
        wait_until(self.images_arrive, "the navigator to see what the camera sees")
        self.repeat()
        self.assert_succeeds()

    def test_joystick_node_while_somebody_drives(self):
        """As if they had let go: it stands, and the repeat goes on by sight."""
        hold = Joy(axes=[0.0, 1.0], buttons=[0, 0, 0, 0, 1])
        wait_until(lambda: self.joystick.get_num_connections() > 0, "the joystick's subscriber")
        self.drive_to(0.5)
        timer = rospy.Timer(rospy.Duration(0.05), lambda _: self.joystick.publish(hold))
        wait_until(lambda: self.states_of(NavigationState.STOPPED, "by hand"), "the person to take over")
        mark = self.robot.mark()
        kill("/teleop")
        self.assert_stops(mark)
        self.assert_succeeds()
        self.assert_guided()
        timer.shutdown()

    def test_who_sent_the_goal(self):
        """It only watches: the repeat goes on to its end, or until somebody else cancels it."""
        self.stack.end(self.stack.repeat)
        self.robot.put_back()
        del self.stack.states[:], self.stack.registrations[:]
        self.begun = self.robot.mark()
        sender = self.start_program("goal", "repeat", "path")
        wait_until(lambda: self.robot.x() > 1.0, "the robot to drive")
        sender.kill()
        wait_until(lambda: self.states_of(NavigationState.FINISHED, ""), "the end of the path")
        self.assertAlmostEqual(self.robot.x(), PATH_M, delta=0.3)
        self.assert_guided()


if __name__ == "__main__":
    FOLDER = rospy.myargv()[1]
    shutil.rmtree(os.path.join(FOLDER, "maps"), ignore_errors=True)
    rospy.init_node("killed_test")
    rostest.rosrun("perennial_nav", "killed", Killed, sys.argv)
