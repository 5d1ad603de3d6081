#!/bin/bash
# Prints a hash of the recorded states of every shipped scene, from the start to END:
#   bash tests/hash_scenes.sh PROGRAM [END] [FOLDER]
# PROGRAM: path of a built pliant; END: simulated time, s (default: 1); FOLDER: folder of the scenes (default: scenes/).
# Each line has the scene, the exit code, and one SHA-256 of q.npy and v.npy together. A change that keeps behaviour
# keeps all lines, on one machine and with one compiler:
#   diff <(bash tests/hash_scenes.sh OLD/pliant) <(bash tests/hash_scenes.sh build/release/apps/pliant)
set -euo pipefail
program=$(realpath "$1")
end=${2:-1}
folder=$(realpath "${3:-$(dirname "$0")/../scenes}")
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
hash_scene='
  name=$(basename "$3" .json)
  status=0
  "$0" run "$3" --end "$2" --quiet --force -o "$1/$name" >"$1/$name.log" 2>&1 || status=$?
  printf "%s %d %s\n" "$name" "$status" "$(cat "$1/$name/q.npy" "$1/$name/v.npy" 2>/dev/null | sha256sum | cut -d " " -f 1)"'
find "$folder" -maxdepth 1 -name '*.json' ! -name '*schema.json' -print0 |
  xargs -0 -n 1 -P "$(nproc)" bash -c "$hash_scene" "$program" "$out" "$end" | sort
