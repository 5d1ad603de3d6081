#!/bin/bash
# Measures each problem in pliant and then in the peers, so that other load of the machine affects both equally. Repeats the
# measurements ROUNDS times, and writes the smallest time of each run.
#   bench/peers/beside.sh FOLDER WORK_PRECISION ROUNDS PROBLEMS [options of run.py]
#   bench/peers/beside.sh out build/release/bench/work_precision 2 "A B C8"
# FOLDER: the folder in which run.sh has installed the peers. The script writes the tables of work_precision and peers.csv
# to FOLDER. If FOLDER already contains times of earlier rounds, the script uses them too.
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
