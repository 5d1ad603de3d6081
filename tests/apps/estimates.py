"""Compares the time of a run that `pliant check` estimates with the time that the run takes, for all scenes of a folder.

The estimate must be within a factor of 3 of the measured time, or within 0.1 s of it. Because other programs of the
machine change both times, a scene fails only after three attempts. Prints a table.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

FACTOR, SECONDS, ATTEMPTS = 3, 0.1, 3
ESTIMATE = re.compile(r"about (\S+) s of computation")


def estimate(program, scene):
    """Returns the estimated time of the steps of a run, s."""
    text = subprocess.run([program, "check", scene], check=True, capture_output=True, text=True).stdout
    return float(ESTIMATE.search(text).group(1))


def measure(program, scene):
    """Returns the measured time of the steps of a run, s."""
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder) / "run"
        subprocess.run([program, "run", scene, "--quiet", "-o", output], check=True, capture_output=True)
        return json.loads((output / "run.json").read_text())["wall_seconds"]["simulate"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("scenes", type=pathlib.Path, help="folder of the scenes")
    arguments = parser.parse_args()
    failed = []
    for scene in sorted(arguments.scenes.glob("*.json")):
        if scene.name.endswith(".schema.json"):
            continue
        for _ in range(ATTEMPTS):
            expected, taken = estimate(arguments.program, scene), measure(arguments.program, scene)
            good = taken / FACTOR <= expected <= taken * FACTOR or abs(expected - taken) <= SECONDS
            print(f"{scene.name:32} estimated {expected:8.3g} s, measured {taken:8.3g} s, ratio {expected / taken:5.2f}"
                  f"{'' if good else ', not within the bounds'}", flush=True)
            if good:
                break
        else:
            failed.append(scene.name)
    if failed:
        sys.exit(f"estimates are wrong for {', '.join(failed)}")


if __name__ == "__main__":
    main()
