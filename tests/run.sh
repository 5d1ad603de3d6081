#!/bin/sh
# Builds everything and runs all tests on a bare Debian machine; missing packages are installed first. Arguments are
# passed to ctest (for example: -R dual, -LE long). The exit status is 4 if packages are missing and cannot be installed.
set -eu
cd "$(dirname "$0")/.."
. apps/setup.sh

pliant_install $pliant_test_packages
pliant_configure release -DPLIANT_TESTS=ON -DPLIANT_BENCH=ON
pliant_build release
ctest --test-dir build/release -j2 --output-on-failure "$@"
