#!/usr/bin/env python3
"""Starts the nodes of repeat.launch from an install space and asks map_manager for a map that does not exist.

    install_space_client.py INSTALL_SPACE        in an environment that has sourced its setup.bash
"""
import os
import signal
import socket
import subprocess
import sys
import time

import rospkg
import rospy
from perennial_nav.srv import BeginTraversal, BeginTraversalRequest

PATIENCE_S = 60.0


def free_port():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


def expect(condition, complaint):
    if not condition:
        raise AssertionError(complaint)


def call_when_there(name, kind, request, process):
    """The service's answer, once it is there and while roslaunch runs."""
    deadline = time.monotonic() + PATIENCE_S
    while process.poll() is None and time.monotonic() < deadline:
        try:
            rospy.wait_for_service(name, timeout=0.5)
            return rospy.ServiceProxy(name, kind)(request)
        except (OSError, rospy.ROSException):
            continue
    raise AssertionError('no service %s; roslaunch: %s' % (name, process.poll()))


def executables_under(folder):
    """Programs in a folder that run now."""
    names = set()
    for pid in filter(str.isdigit, os.listdir('/proc')):
        try:
            program = os.readlink('/proc/%s/exe' % pid)
        except OSError:
            continue
        if program.startswith(folder + '/'):
            names.add(os.path.basename(program))
    return names


def check(space, process):
    request = BeginTraversalRequest(map_name='no_such_map')
    answer = call_when_there('/begin_traversal', BeginTraversal, request, process)
    expect(not answer.success and 'no_such_map' in answer.message, 'begin_traversal: %s' % answer)
    print('begin_traversal:', answer.message)
    running = executables_under(space)
    expect({'map_manager_node', 'repeat_navigator_node'} <= running, 'running from %s: %s' % (space, running))


def main(space):
    space = os.path.realpath(space)
    found = os.path.realpath(rospkg.RosPack().get_path('perennial_nav'))
    expect(found.startswith(space), 'perennial_nav is found in %s' % found)
    os.environ['ROS_MASTER_URI'] = 'http://127.0.0.1:%d' % free_port()
    port = os.environ['ROS_MASTER_URI'].rpartition(':')[2]
    process = subprocess.Popen(['roslaunch', '--port', port, 'perennial_nav', 'repeat.launch', 'strategy:=score_based',
                                'map_folder:=' + os.path.join(space, 'maps')], start_new_session=True)
    try:
        check(space, process)
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(60)
    expect(not executables_under(space), 'left running: %s' % executables_under(space))


if __name__ == '__main__':
    main(*sys.argv[1:])
