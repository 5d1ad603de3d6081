#!/bin/bash
# Measures pliant and the peers in alternation, on a machine that others use: each problem in pliant, then in the peers.
# Repeats this ROUNDS times; the smallest times are written.
#   bench/peers/beside.sh FOLDER WORK_PRECISION ROUNDS PROBLEMS [options of run.py]
#   bench/peers/beside.sh out build/release/bench/work_precision 2 "A B C8"
# FOLDER: the folder in which run.sh has installed the peers. work_precision.csv, its tables and peers.csv are written
# to it. Results of earlier rounds in it are used too.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[ $# -ge 4 ] || { sed -n '2,7s/^# //p' "$0" >&2; exit 2; }
folder=$1 work_precision=$2 rounds=$3 problems=$4
shift 4
for ((round = 1; round <= rounds; ++round)); do
  for problem in $problems; do
    "$work_precision" --only "$problem" --again "$folder"
    "$folder/venv/bin/python" "$here/run.py" "$folder" --problems "$problem" --again "$@"
  done
done
