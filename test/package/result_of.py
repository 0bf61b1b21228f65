#!/usr/bin/env python3
"""Runs a command as a test with one case, and writes its result as JUnit XML for catkin.

    result_of.py RESULT_XML NAME COMMAND [ARGUMENT...]

Exit status 77 of the command means that it was skipped, as with Automake and CTest.
"""
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree

SKIPPED = 77


def main(path, name, *command):
    start = time.monotonic()
    process = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    sys.stdout.write(process.stdout)
    failed = process.returncode not in (0, SKIPPED)
    suite = ElementTree.Element('testsuite', name=name, tests='1', failures=str(int(failed)), errors='0')
    duration = '%.3f' % (time.monotonic() - start)
    case = ElementTree.SubElement(suite, 'testcase', classname='package', name=name, time=duration)
    if failed:
        failure = ElementTree.SubElement(case, 'failure', message='ended with status %d' % process.returncode)
        failure.text = process.stdout
    elif process.returncode == SKIPPED:
        ElementTree.SubElement(case, 'skipped', message=process.stdout.strip())
    ElementTree.ElementTree(suite).write(path, encoding='utf-8', xml_declaration=True)
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
