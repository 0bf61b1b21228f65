"""Two machines on one: network namespaces that only a link joins, which can be cut and can lose packets.

A test becomes a program of the first machine, "robot", by enter(), and starts what runs on the second one, "computer", through
Machines. Nothing of it outlives the test, however that ends: a namespace ends with its last process, and every process
that is started here ends with the test.
"""
import os
import subprocess
import sys

ROBOT, COMPUTER = "10.0.0.1", "10.0.0.2"
INSIDE = "PERENNIAL_TEST_MACHINE"  # set in the environment of programs that have their own namespace
LOSS = ["-i", "wire", "-m", "statistic", "--mode", "random", "--probability"]
# With root's rights here, or with those of a user who may be root in a namespace.
WAYS_IN = (["unshare", "--net"], ["unshare", "--user", "--map-root-user", "--net"])
WITH_PARENT = ["setpriv", "--pdeathsig", "KILL"]


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)


def why_not(way_in):
    """What is missing for two machines with this way into a namespace; None if nothing is."""
    trial = "ip link add name wire type veth peer name other && iptables -A INPUT %s 0.5 -j DROP" % " ".join(LOSS)
    try:
        run(*way_in, "sh", "-c", trial)
    except OSError as error:
        return str(error)
    except subprocess.CalledProcessError as error:
        return error.stdout.strip() or str(error)
    return None


def enter():
    """Starts this program anew on the machine "robot". Returns there; or with the reason why there can be no such machine."""
    if INSIDE in os.environ:
        return None
    reasons = []
    for way_in in WAYS_IN:
        reason = why_not(way_in)
        if reason is None:
            os.environ[INSIDE] = "robot"
            os.execvp(way_in[0], [*way_in, sys.executable, *sys.argv])
        reasons.append("%s: %s" % (" ".join(way_in), reason))
    return "; ".join(reasons)


class Machines:
    """The other machine, and the link to it. To be created on the machine "robot"."""

    def __init__(self):
        self.processes = []
        # Keeps the namespace until its input ends, which is with this process at the latest.
        self.keeper = subprocess.Popen(
            ["unshare", "--net", "sh", "-c", "ip link set lo up && echo ready && exec cat"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE)  # fmt: skip
        assert self.keeper.stdout.readline() == b"ready\n"
        run("ip", "link", "set", "lo", "up")
        run("ip", "link", "add", "name", "wire", "type", "veth",
            "peer", "name", "wire", "netns", str(self.keeper.pid))  # fmt: skip
        for on, address in (([], ROBOT), (self.on_computer(), COMPUTER)):
            run(*on, "ip", "address", "add", address + "/24", "dev", "wire")
            run(*on, "ip", "link", "set", "wire", "up")

    def on_computer(self):
        """What comes before a command to run it on the other machine."""
        return ["nsenter", "--net", "--target", str(self.keeper.pid)]

    def start(self, address, log, *command):
        """Starts a program of ROS on the machine with this address; its output goes to a file."""
        environment = dict(os.environ, ROS_IP=address, ROS_MASTER_URI="http://%s:11311" % ROBOT)
        environment.pop("ROS_HOSTNAME", None)  # which would come before ROS_IP
        on = self.on_computer() if address == COMPUTER else []
        with open(log, "wb") as output:
            process = subprocess.Popen(
                [*WITH_PARENT, *on, *command], env=environment, stdin=subprocess.DEVNULL, stdout=output, stderr=output)
        self.processes.append(process)
        return process

    def end(self):
        for process in self.processes:
            process.kill()
            process.wait()
        self.keeper.communicate()

    # --- the link ---

    @staticmethod
    def unplug():
        run("ip", "link", "set", "wire", "down")

    def silence(self):
        """Packets are swallowed, as out of reach of a radio: neither side is told."""
        self.lose(1.0)

    def lose(self, probability):
        for on in ([], self.on_computer()):
            run(*on, "iptables", "-A", "INPUT", *LOSS, str(probability), "-j", "DROP")

    def restore(self):
        run("ip", "link", "set", "wire", "up")
        for on in ([], self.on_computer()):
            run(*on, "iptables", "-F", "INPUT")
