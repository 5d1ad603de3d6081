#!/bin/bash
# Installs the peers in FOLDER and runs the problems of problems.py in the peers:  bench/peers/run.sh FOLDER [options of run.py]
# With --contact, --contact-precision or --contact-pairs after FOLDER, runs contact.py, contact_precision.py or
# contact_pairs.py instead of run.py:  bench/peers/run.sh FOLDER --contact [options of contact.py]
# Requires a C++ compiler, CMake and libeigen3-dev for the compiled peers, and libsimbody-dev for Simbody.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[ $# -ge 1 ] || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }
folder=$1
shift
script=run.py
case "${1:-}" in
  --contact) script=contact.py; shift ;;
  --contact-precision) script=contact_precision.py; shift ;;
  --contact-pairs) script=contact_pairs.py; shift ;;
esac
mkdir -p "$folder"
python="$folder/venv/bin/python"
[ -x "$python" ] || python3 -m venv "$folder/venv"
# Packages are installed one by one. If an engine has no wheel for this machine, only this engine is skipped, with a message.
sed 's/#.*//' "$here/requirements.txt" | while read -r package; do
  [ -z "$package" ] || "$python" -m pip install -q --disable-pip-version-check "$package" ||
    echo "$package: not installed" >&2
done
exec "$python" "$here/$script" "$folder" "$@"
