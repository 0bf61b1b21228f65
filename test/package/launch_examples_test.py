#!/usr/bin/env python3
"""Every roslaunch command of the README, the docs and the launch files' own comments names nodes to start, without an error.

    launch_examples_test.py REPOSITORY
"""
import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile

COMMAND = re.compile(r"roslaunch perennial_nav (\w+\.launch)((?:[ \t]+\[?\w+:=[^\s\]`]*\]?|[ \t]*\\\n[ \t]*)*)")


def examples(repository):
    """(file, launch file, arguments) of each command; what stands in brackets may be left out, and is tried both ways."""
    found = set()
    for pattern in ("README.md", "docs/*.md", "launch/*.launch"):
        for path in glob.glob(os.path.join(repository, pattern)):
            with open(path) as file:
                for launch, words in COMMAND.findall(file.read()):
                    words = [w for w in words.replace("\\\n", " ").split() if not w.endswith(":=...")]
                    needed = tuple(w for w in words if not w.startswith("["))
                    for arguments in (needed, tuple(w.strip("[]") for w in words)):
                        found.add((os.path.relpath(path, repository), launch, arguments))
    return sorted(found)


def fill(folder, repository, arguments):
    """The folder for $PWD gets the configurations that are somebody's own: copies of the navigator's."""
    for argument in arguments:
        name, value = argument.split(":=", 1)
        if name == "config" and value.startswith("$PWD/"):
            shutil.copy(os.path.join(repository, "config", "repeat_navigator.yaml"), value.replace("$PWD", folder))


def main(repository):
    with tempfile.TemporaryDirectory() as folder:
        return check(repository, folder)


def check(repository, folder):
    commands = examples(repository)
    if len(commands) < 5:
        sys.exit("only %d commands found: the pattern does not fit the documents" % len(commands))
    failed = 0
    for path, launch, arguments in commands:
        fill(folder, repository, arguments)
        command = ["roslaunch", "--nodes", "perennial_nav", launch] + [a.replace("$PWD", folder) for a in arguments]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        nodes = [line for line in done.stdout.splitlines() if line.startswith("/")]
        good = done.returncode == 0 and nodes
        failed += not good
        print("%s  %s: %s" % ("ok    " if good else "FAILED", path, " ".join(command)))
        if not good:
            print(done.stdout)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
