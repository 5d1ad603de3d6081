#!/bin/bash
# Measures run time against error: writes the tables of work_precision to FOLDER. Draws run time against each kind of error,
# and the number of evaluations against the error at the end.
# usage: bench/precision.sh FOLDER WORK_PRECISION [options]     WORK_PRECISION: path of the program work_precision; options:
# its options --all, --only PROBLEM and --again
set -euo pipefail
[ $# -ge 2 ] || { sed -n '2,5s/^# \?//p' "$0"; exit 2; }
folder=$1 program=$2
shift 2
plot=$(dirname "$0")/plot.py
"$program" "$folder" "$@"
for quantity in error error_along error_v error_lambda gap_m balance_J; do
  python3 "$plot" "$folder/work_precision.csv" "$folder/over_time_$quantity.png" --of "$quantity"
done
python3 "$plot" "$folder/work_precision.csv" "$folder/over_evaluations_error.png" --cost evaluations
