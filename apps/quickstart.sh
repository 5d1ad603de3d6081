#!/bin/sh
# From a bare Debian machine to the first pictures: installs what is missing, builds the program, runs a scene.
# Ends with status 4 when packages are missing and there is no way to install them.
set -eu
cd "$(dirname "$0")/.."
. apps/setup.sh

pliant_install
if [ -f build/release/CMakeCache.txt ]; then
  pliant_configure release
else
  pliant_configure release -DPLIANT_TESTS=OFF -DPLIANT_BENCH=OFF
fi
pliant_build release --target pliant
build/release/apps/pliant run scenes/pull.json --obj --png --force -o out/pull
pliant_say "meshes and pictures are in $(pwd)/out/pull"
