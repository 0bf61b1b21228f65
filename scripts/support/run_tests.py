"""Runs the tests that CTest knows in a build folder and counts test cases from the JUnit files that they write.

    run_tests.py BUILD_FOLDER [PATTERN]

Unit tests run side by side, one per processor; then those that start ROS nodes (rostest) one by one, for they depend on
timing. A program that crashes, is stopped for running too long, or leaves no result counts as one failure. The last line is
"N passed, N failed".
"""
import concurrent.futures
import glob
import json
import os
import re
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree

# A guard against programs that hang, even on a busy machine; no test waits for it.
TIMEOUT_S = 1800


class Count:
    """Number of test cases that passed, and a line for each that was skipped or failed."""

    def __init__(self):
        self.passed = 0
        self.skipped = []
        self.failures = []

    def add(self, other):
        self.passed += other.passed
        self.skipped += other.skipped
        self.failures += other.failures

    def __str__(self):
        return '%d passed, %d failed' % (self.passed, len(self.failures))


class Test:
    """An entry of CTest: its command, its folder, and the file that its results go to."""

    def __init__(self, entry):
        # A rostest's name has its arguments at the end, paths among them.
        self.name = re.sub('^_ctest_perennial_nav_', '', entry['name']).split('__')[0]
        self.command = entry.get('command', [])
        properties = {p['name']: p['value'] for p in entry.get('properties', [])}
        self.folder = properties.get('WORKING_DIRECTORY')
        self.is_rostest = self.name.startswith('rostest_')
        self.result = next((a for a in self.command if a.endswith('.xml') and '/test_results/' in a), None)


def list_tests(build, pattern):
    listing = subprocess.run(['ctest', '--show-only=json-v1'], cwd=build, check=True, stdout=subprocess.PIPE).stdout
    tests = [Test(entry) for entry in json.loads(listing)['tests']]
    return [t for t in tests if re.search(pattern, t.name)]


def count_cases(path):
    """The cases of one JUnit file."""
    count = Count()
    for case in ElementTree.parse(path).iter('testcase'):
        problems = case.findall('failure') + case.findall('error')
        skipped = case.findall('skipped')
        message = next((p.get('message') or p.text or '' for p in problems + skipped), '').strip()
        line = '%s.%s: %s' % (case.get('classname'), case.get('name'), message)
        if problems:
            count.failures.append(line)
        elif skipped or case.get('result') == 'skipped' or case.get('status') == 'notrun':
            count.skipped.append(line)
        else:
            count.passed += 1
    return count


def count_results(test, started):
    """All cases that a test wrote since it was started.

    A rostest's own file has one case for each test program, which fails if the program ended without results; the cases
    themselves are in files that are named by the programs.
    """
    if not test.result or not os.path.exists(test.result) or os.path.getmtime(test.result) < started:
        return Count()
    count = count_cases(test.result)
    if test.is_rostest:
        count.passed = 0
        for path in glob.glob(os.path.join(os.path.dirname(test.result), 'rosunit-*.xml')):
            if os.path.getmtime(path) >= started:
                count.add(count_cases(path))
    return count


def execute(command, folder, log):
    """Runs a command in a process group of its own and leaves nothing of it running; what went wrong, or nothing."""
    process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                               start_new_session=True)
    try:
        status = process.wait(TIMEOUT_S)
    except subprocess.TimeoutExpired:
        # rostest passes an interrupt on to its nodes, which have sessions of their own.
        os.killpg(process.pid, signal.SIGINT)
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            pass
        return 'stopped after %d s' % TIMEOUT_S
    finally:
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    return 'ended with status %d' % status if status else None


def run(test, logs):
    """Runs one test and prints its outcome, and its output if it failed."""
    log_path = os.path.join(logs, test.name + '.log')
    # File systems may stamp a file a little earlier than the clock that is read here.
    started = time.time() - 0.1
    with open(log_path, 'wb') as log:
        problem = execute(test.command, test.folder, log)
    try:
        count = count_results(test, started)
    except ElementTree.ParseError as error:
        count, problem = Count(), 'damaged result: %s' % error
    if not count.failures and (problem or not count.passed + len(count.skipped)):
        count.failures.append('%s: %s' % (test.name, problem or 'left no result'))
    report = '%s  %s (%.1f s)\n' % ('FAILED' if count.failures else 'ok    ', test.name, time.time() - started)
    if count.failures:
        with open(log_path, errors='replace') as log:
            report += ''.join(log.readlines()[-60:])
        report += ''.join('   %s\n' % line for line in count.failures) + '   all of its output: %s\n' % log_path
    sys.stdout.write(report)
    sys.stdout.flush()
    return count


def main(build, pattern=''):
    tests = list_tests(build, pattern)
    if not tests:
        sys.exit('No test is named like "%s".' % pattern)
    logs = os.path.join(build, 'test_logs')
    os.makedirs(logs, exist_ok=True)
    total = Count()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for count in pool.map(lambda t: run(t, logs), [t for t in tests if not t.is_rostest]):
            total.add(count)
    for test in tests:
        if test.is_rostest:
            total.add(run(test, logs))
    for line in total.failures:
        print('FAILED ' + line.splitlines()[0])
    for line in total.skipped:
        print('skipped ' + line.splitlines()[0])
    if total.skipped:
        print('%d skipped' % len(total.skipped))
    print(total)
    sys.exit(1 if total.failures else 0)


if __name__ == '__main__':
    main(*sys.argv[1:])
