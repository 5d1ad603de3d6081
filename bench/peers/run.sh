#!/bin/bash
# Installs the peers in FOLDER and runs the problems in them:  bench/peers/run.sh FOLDER [options of run.py]
# Runs the contact problems instead:  bench/peers/run.sh FOLDER --contact [options of contact.py]
# Requires a C++ compiler, CMake and libeigen3-dev for the compiled peers, and libsimbody-dev for Simbody.
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
# Packages are installed one by one, so that only an engine without a wheel for this machine is skipped, with a message.
sed 's/#.*//' "$here/requirements.txt" | while read -r package; do
  [ -z "$package" ] || "$python" -m pip install -q --disable-pip-version-check "$package" ||
    echo "$package: not installed" >&2
done
exec "$python" "$here/$script" "$folder" "$@"
