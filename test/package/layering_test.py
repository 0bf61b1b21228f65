#!/usr/bin/env python3
"""The rooms of the house include only what they may: none but the ROS layer knows ROS.

    layering_test.py SOURCE_FOLDER
"""
import os
import re
import sys

CORE = ['perennial/core/', 'core/']
# Folders, and beginnings of what they may include besides standard headers, which have no folder in their names.
ROOMS = {
    'include/perennial/core': ['perennial/core/', 'opencv2/core'],
    'src/core': CORE + ['opencv2/', 'boost/crc.hpp', 'hwy/', 'sys/'],
    'include/perennial/strategies': ['perennial/core/', 'perennial/strategies/', 'opencv2/core'],
    'src/strategies': CORE + ['perennial/strategies/', 'opencv2/', 'pluginlib/class_list_macros.hpp'],
    'include/perennial/park': ['perennial/core/', 'perennial/park/', 'opencv2/core'],
    'src/park': CORE + ['perennial/park/', 'park/', 'opencv2/', 'yaml-cpp/', 'osg', 'EGL/', 'GL/'],
    'test/core': CORE + ['perennial/testing/', 'perennial/strategies/', 'opencv2/', 'gtest/', 'boost/crc.hpp', 'sys/',
                         'yaml-cpp/', 'strategies/'],
}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def sources(folder):
    for root, _, names in os.walk(folder):
        for name in sorted(names):
            if name.endswith(('.h', '.hpp', '.cpp')):
                yield os.path.join(root, name)


def offences(path, allowed):
    with open(path, encoding='utf-8') as file:
        text = file.read()
    for match in INCLUDE.finditer(text):
        bracket, header = match.groups()
        beside = bracket == '"' and os.path.exists(os.path.join(os.path.dirname(path), header))
        if '/' in header and not beside and not header.startswith(tuple(allowed)):
            yield '%s:%d includes %s' % (path, text.count('\n', 0, match.start(2)) + 1, header)


def main(folder):
    complaints, seen = [], 0
    for room, allowed in ROOMS.items():
        files = list(sources(os.path.join(folder, room)))
        if not files:
            complaints.append('%s holds no sources: has it moved?' % room)
        seen += len(files)
        complaints += [line for path in files for line in offences(path, allowed)]
    print('%d files' % seen)
    print('\n'.join(complaints))
    return 1 if complaints else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
