#!/bin/bash
# Installs the peers in FOLDER and runs the problems in them:  bench/peers/run.sh FOLDER [options of run.py]
# Those of contact instead:  bench/peers/run.sh FOLDER --contact [options of contact.py]
# Simbody is of the system (libsimbody-dev); a C++ compiler, CMake and libeigen3-dev build the compiled peers.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[ $# -ge 1 ] || { sed -n '2,4s/^# //p' "$0" >&2; exit 2; }
folder=$1
shift
script=run.py
[ "${1:-}" != --contact ] || { script=contact.py; shift; }
mkdir -p "$folder"
python="$folder/venv/bin/python"
[ -x "$python" ] || python3 -m venv "$folder/venv"
# One by one: an engine that has no wheel for this machine is left out, and the script says so.
sed 's/#.*//' "$here/requirements.txt" | while read -r package; do
  [ -z "$package" ] || "$python" -m pip install -q --disable-pip-version-check "$package" ||
    echo "$package: not installed" >&2
done
exec "$python" "$here/$script" "$folder" "$@"
