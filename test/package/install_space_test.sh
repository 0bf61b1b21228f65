#!/bin/bash
# The stack runs from where it is installed, without the devel space: its nodes start from the installed launch files,
# with their installed parameters, and load a strategy plugin.
#
#   install_space_test.sh BUILD_FOLDER DEVEL_SPACE
set -eo pipefail
build=$1 devel=$2
here=$(cd "$(dirname "$0")" && pwd)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' INT TERM
cmake --install "$build" --prefix "$scratch/space" >"$scratch/install.log" || { cat "$scratch/install.log" && exit 1; }
if grep -rIlF "$devel" "$scratch/space"; then
  echo "these files name the devel space" && exit 1
fi

# The space under test alone, nothing that happens to be sourced.
unset CMAKE_PREFIX_PATH ROS_PACKAGE_PATH CATKIN_ENV_HOOK_WORKSPACE LD_LIBRARY_PATH PYTHONPATH PKG_CONFIG_PATH
. "$scratch/space/setup.bash"
export ROS_IP=127.0.0.1 ROS_HOME=$scratch/ros ROS_LOG_DIR=$scratch/ros/log
mkdir -p "$ROS_LOG_DIR"
cd "$scratch"
/usr/bin/python3 "$here/install_space_client.py" "$scratch/space"
