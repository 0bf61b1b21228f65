"""kill -9 of nodes that roslaunch starts anew."""
import os
import signal
import xmlrpc.client

import rosgraph
import rospy
from fake_robot import wait_until


def process_of(node):
    """The process id of a node; None while it is not there."""
    try:
        address = rosgraph.Master(rospy.get_name()).lookupNode(node)
        return xmlrpc.client.ServerProxy(address).getPid(rospy.get_name())[2]
    except (rosgraph.MasterError, OSError):
        return None


def kill(node):
    """Returns the process id that it had."""
    process = process_of(node)
    assert process is not None, node + " is not there"
    os.kill(process, signal.SIGKILL)
    return process


def wait_for_new(node, killed):
    wait_until(lambda: process_of(node) not in (None, killed), node + " to be started anew")
