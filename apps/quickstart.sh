#!/bin/sh
# Draws the first pictures on a new Debian machine: installs missing packages, builds the program and runs a scene.
# Ends with status 4 if packages are missing and cannot be installed.
set -eu
cd "$(dirname "$0")/.."
. apps/setup.sh

pliant_install
pliant_begin "build of the program" \
  "about $pliant_minutes_program minutes on 2 cores in a new folder, with $(pliant_jobs) jobs here"
if [ -f build/release/CMakeCache.txt ]; then
  pliant_configure release
else
  pliant_configure release -DPLIANT_TESTS=OFF -DPLIANT_BENCH=OFF
fi
pliant_build release --target pliant
pliant_end

pliant_begin "scene" "scenes/pull.json with meshes and pictures, less than half a minute"
build/release/apps/pliant run scenes/pull.json --obj --png --force -o out/pull
pliant_end
pliant_say "meshes and pictures are in $(pwd)/out/pull"
