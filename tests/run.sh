#!/bin/sh
# Builds everything and runs all tests, from a bare Debian machine: installs missing packages first. Arguments go to ctest
# (for example: -R contact, -LE long). With --long as the first argument, the tests that take an hour run, too. Ends with
# status 4 if packages are missing and cannot be installed.
set -eu
cd "$(dirname "$0")/.."
. apps/setup.sh

pliant_install $pliant_test_packages
pliant_begin "build" \
  "about $pliant_minutes_everything minutes on 2 cores from nothing, with $(pliant_jobs) jobs here"
pliant_configure release -DPLIANT_TESTS=ON -DPLIANT_BENCH=ON
pliant_build release
pliant_end

if [ "${1:-}" = --long ]; then
  shift
  set -- -C Extended "$@"
  pliant_begin "tests" "about two hours on 2 cores for all of them"
else
  pliant_begin "tests" "about $pliant_minutes_tests minutes on 2 cores for all of them"
fi
status=0
ctest --test-dir build/release -j2 --output-on-failure "$@" || status=$?
pliant_end
exit "$status"
