#!/bin/bash
# Libraries that must not be linked against ROS.
#
#   free_of_ros_test.sh LIBRARY...
set -euo pipefail
status=0
for library in "$@"; do
  needed=$(readelf --dynamic --wide "$library" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
  [[ $needed == *libc.so* ]] || { echo "$library: no libraries found in it" && status=1; }
  if grep -E '^lib(ros|tf2|cv_bridge|image_transport|actionlib|class_loader|console_bridge|topic_tools|xmlrpcpp)' <<<"$needed"; then
    echo "$library needs these" && status=1
  fi
done
exit $status
