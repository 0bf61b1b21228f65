#!/usr/bin/env python3
"""With ROS_IP or ROS_HOSTNAME on the loopback interface, nodes listen there alone: with all of their sockets but one, the XML-RPC
server of roscpp's nodes, which docs/reliability.md tells how to close."""
import ipaddress
import os
import socket
import subprocess
import sys
import unittest

import roslib.packages
import rosgraph
import rostest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from fake_robot import wait_until  # noqa: E402

LISTENING = "0A"  # of TCP, in /proc/net/tcp
UNCONNECTED = "07"  # of UDP
NODES = {
    "cameleon_driver": ["_robot_host:=127.0.0.1", "_robot_port:=1"],
    "cameleon_simulator": ["_port:=0"],
    "map_manager": ["_map_folder:=/tmp", "_strategy:=static"],
    "repeat_navigator": ["_every_image:=false"],
    "teach_recorder": ["_map_folder:=/tmp"],
    "teleop": [],
}


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def address_of(number):
    """Of the kernel's way to write one: words of 32 bits, each in the machine's order of bytes."""
    words = [int(number[i : i + 8], 16).to_bytes(4, sys.byteorder) for i in range(0, len(number), 8)]
    address = ipaddress.ip_address(b"".join(words))
    return getattr(address, "ipv4_mapped", None) or address


def opened_by(folder):
    opened = set()
    for name in os.listdir(folder + "fd"):
        try:
            opened.add(os.readlink(folder + "fd/" + name))
        except FileNotFoundError:
            pass  # closed meanwhile
    return opened


def sockets_of(process):
    """Addresses and ports on which a process waits for others."""
    folder = "/proc/%d/" % process.pid
    found = []
    opened = opened_by(folder)
    for protocol, state in (("tcp", LISTENING), ("tcp6", LISTENING), ("udp", UNCONNECTED), ("udp6", UNCONNECTED)):
        if not os.path.exists(folder + "net/" + protocol):
            continue
        with open(folder + "net/" + protocol) as table:
            for line in list(table)[1:]:
                columns = line.split()
                if columns[3] == state and "socket:[%s]" % columns[9] in opened:
                    address, port = columns[1].split(":")
                    found.append((address_of(address), int(port, 16)))
    return found


class Loopback(unittest.TestCase):
    def setUp(self):
        self.processes = []

    def tearDown(self):
        for process in self.processes:
            process.kill()
            process.wait()

    def start(self, command, **environment):
        environment = dict(os.environ, ROS_MASTER_URI=self.uri, **environment)
        for name in ("ROS_IP", "ROS_HOSTNAME"):
            if name not in self.setting:
                environment.pop(name, None)
        process = subprocess.Popen(command, env=dict(environment, **self.setting), stdin=subprocess.DEVNULL)
        self.processes.append(process)
        return process

    def port_of(self, node):
        """Of its XML-RPC server; None until it is there."""
        try:
            return int(rosgraph.Master("/loopback_test", master_uri=self.uri).lookupNode(node).rstrip("/").rsplit(":", 1)[1])
        except (rosgraph.MasterException, OSError):
            return None

    def strangers(self, process, besides=None):
        """Sockets that others than this computer can reach; that there are sockets at all is asserted."""
        sockets = sockets_of(process)
        self.assertTrue([port for address, port in sockets if address.is_loopback], process.args)
        return [(str(address), port) for address, port in sockets if not address.is_loopback and port != besides]

    def check(self, **setting):
        self.setting, port = setting, free_port()
        self.uri = "http://127.0.0.1:%d" % port
        master = self.start(["rosmaster", "--core", "-p", str(port)])
        wait_until(lambda: rosgraph.is_master_online(self.uri), "the master")
        listener = self.start(["rostopic", "echo", "/odom", "__name:=listener"])
        nodes = {
            name: self.start([roslib.packages.find_node("perennial_nav", name + "_node")[0], "__name:=" + name, *arguments])
            for name, arguments in NODES.items()
        }
        wait_until(lambda: all(self.port_of("/" + name) for name in nodes), "the nodes")
        wait_until(lambda: sockets_of(listener), "the node of rospy")
        self.assertEqual(self.strangers(master), [])
        self.assertEqual(self.strangers(listener), [])
        for name, process in nodes.items():
            self.assertEqual(self.strangers(process, besides=self.port_of("/" + name)), [], name)

    def test_by_address(self):
        self.check(ROS_IP="127.0.0.1")

    def test_by_name(self):
        self.check(ROS_HOSTNAME="localhost")


if __name__ == "__main__":
    rostest.rosrun("perennial_nav", "loopback", Loopback, sys.argv)
