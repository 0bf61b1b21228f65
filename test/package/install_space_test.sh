#!/bin/bash
# The stack runs from where it is installed, without the devel space: its nodes start from the installed launch files,
# with their installed parameters, and load a strategy plugin.
#
#   install_space_test.sh BUILD_FOLDER DEVEL_SPACE INSTALL_PREFIX
#
# INSTALL_PREFIX is the configured one; nothing is written there, but to the same path below a scratch folder.
set -eo pipefail
build=$1 devel=$2 prefix=$3
here=$(cd "$(dirname "$0")" && pwd)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' INT TERM
DESTDIR=$scratch cmake --install "$build" >"$scratch/install.log" || { tail -n 5 "$scratch/install.log" && exit 1; }
space=$scratch$prefix
if grep -rIlF "$devel" "$space"; then
  echo "these files name the devel space" && exit 1
fi

# The space under test alone, nothing that happens to be sourced.
unset CMAKE_PREFIX_PATH ROS_PACKAGE_PATH CATKIN_ENV_HOOK_WORKSPACE LD_LIBRARY_PATH PYTHONPATH PKG_CONFIG_PATH
. "$space/setup.bash"
export ROS_IP=127.0.0.1 ROS_HOME=$scratch/ros ROS_LOG_DIR=$scratch/ros/log
mkdir -p "$ROS_LOG_DIR"
cd "$scratch"
rosrun perennial_nav goal --help >/dev/null
/usr/bin/python3 "$here/install_space_client.py" "$space"
