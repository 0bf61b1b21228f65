#!/bin/bash
# CMakeLists.txt and package.xml of a package without complaints of catkin_lint.
#
#   lint_test.sh PACKAGE_FOLDER...
set -euo pipefail
if ! command -v catkin_lint >/dev/null; then
  echo "catkin_lint is not installed: skipped"
  exit 77
fi
exec catkin_lint --offline --strict "$@"
