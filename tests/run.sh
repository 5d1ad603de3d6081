#!/bin/sh
# Builds everything and runs all tests, from a bare Debian machine: installs what is missing first. Arguments go to ctest
# (for example: -R dual, -LE long). Ends with status 4 when packages are missing and there is no way to install them.
set -eu
cd "$(dirname "$0")/.."
. apps/setup.sh

pliant_install $pliant_test_packages
pliant_configure release -DPLIANT_TESTS=ON -DPLIANT_BENCH=ON
pliant_build release
ctest --test-dir build/release -j2 --output-on-failure "$@"
