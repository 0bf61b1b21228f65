#!/bin/bash
# Builds the example strategy in a catkin workspace of its own, on top of a built or installed perennial_nav, and runs
# its tests, which load it by name.
#
#   run_example.sh SETUP_SH EXAMPLE_DIR WORKSPACE RESULT_XML
#
# SETUP_SH: setup.sh of the devel or install space. The workspace is kept, so that a second run builds only what changed.
set -eo pipefail
setup=$1 example=$2 workspace=$3 result=$4
# The system's Python has catkin's packages, another one that comes first in PATH may not.
export PATH=/usr/lib/ccache:/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
# The space under test alone, nothing that happens to be sourced.
unset CMAKE_PREFIX_PATH ROS_PACKAGE_PATH CATKIN_ENV_HOOK_WORKSPACE LD_LIBRARY_PATH PYTHONPATH PKG_CONFIG_PATH
. "$setup"
mkdir -p "$workspace/src"
cp -ru "$example" "$workspace/src/"
catkin_make -C "$workspace" -j2 -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCATKIN_ENABLE_TESTING=ON all tests
. "$workspace/devel/setup.sh"
"$workspace/devel/lib/perennial_example_strategy/oldest_first_test" --gtest_output="xml:$result"
