#!/bin/bash
# pliant and the peers beside each other, on a machine that others use too: each problem here, then in the peers;
# and all of that again, of which the least times count:
#   bench/peers/beside.sh FOLDER WORK_PRECISION ROUNDS PROBLEMS [options of run.py]
#   bench/peers/beside.sh out build/release/bench/work_precision 2 "A B C8"
# FOLDER: where run.sh has installed the peers; gets work_precision.csv and its tables, and peers.csv. The ROUNDS
# are added to those that it has.
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
