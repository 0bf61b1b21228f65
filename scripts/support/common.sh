# Sourced by the scripts of the folder above: environment, messages, the workspace.
# shellcheck shell=bash
set -euo pipefail

# The system's own tools, whatever comes first in the caller's PATH: another python3 has no catkin_pkg, rospy or cv2.
export PATH=/usr/lib/ccache:/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
# Nothing of a workspace, a ROS system or a virtual environment that happens to be sourced.
unset AMENT_PREFIX_PATH CATKIN_ENV_HOOK_WORKSPACE CDPATH CMAKE_PREFIX_PATH GTEST_FILTER LD_LIBRARY_PATH MAKEFLAGS \
  PKG_CONFIG_PATH PYTHONHOME PYTHONPATH ROSLAUNCH_SSH_UNKNOWN ROS_DISTRO ROS_ETC_DIR ROS_HOSTNAME ROS_IP \
  ROS_MASTER_URI ROS_NAMESPACE ROS_PACKAGE_PATH ROS_ROOT ROS_VERSION VIRTUAL_ENV

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)
# Everything that is built or logged goes here; may be set from outside, as for a checkout that cannot be written to.
workspace=${PERENNIAL_WORKSPACE:-$repository/.workspace}

say() { printf '== %s\n' "$*"; }
die() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

# Prints the comment at the head of the calling script.
usage() { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"; }

# Creates the workspace; complains when it is somebody else's.
open_workspace() {
  mkdir -p "$workspace" 2>/dev/null && [[ -w $workspace ]] ||
    die "cannot write to $workspace (built by another user?): remove it, or set PERENNIAL_WORKSPACE to another folder"
  workspace=$(cd "$workspace" && pwd -P)
}

# To be called before anything of ROS is run: logs and caches go to the workspace, nothing to the home folder.
keep_home_clean() {
  export ROS_HOME=$workspace/ros ROS_LOG_DIR=$workspace/ros/log
  export XDG_CACHE_HOME=$workspace/cache XDG_CONFIG_HOME=$workspace/config
  mkdir -p "$ROS_LOG_DIR"
  # Whatever this machine is called and whatever that name resolves to.
  export ROS_IP=127.0.0.1
}
