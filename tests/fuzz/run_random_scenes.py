"""Runs random valid scenes (random_scene.py) and checks that

- the program ends with a documented exit code, and never by a signal;
- no file of the run contains inf or nan;
- a run with code 0 has a small error of the energy balance, or its method is of order 1 and its notes report it;
- the message of a failure names a part or a joint and the time;
- the step, tolerance or method that a message recommends reaches the end of the scene, with code 0 unless the message
  gives the error of its energy balance.

A run that takes longer than --seconds is interrupted and reported as slow.
"""

import argparse
import array
import collections
import concurrent.futures
import csv
import json
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

from random_scene import random_scene

DONE, BAD_SCENE, UNSATISFIABLE, NUMERICAL, INACCURATE, INTERRUPTED = 0, 3, 4, 5, 6, 128 + signal.SIGINT
REPORTED_SHARE, LARGEST_SHARE = 0.01, 0.5
ORDERS = {"rk4": 4, "linearly_implicit": 2, "implicit_midpoint": 2, "esdirk": 4, "dormand_prince": 5, "dop853": 8}
# A random geometry may be invalid; the program must then refuse the scene with one of these messages.
REFUSALS = re.compile("folds over|too coarse|inside out|neither end|no direction|tip|axis")
REMEDY = re.compile(r"; (a step of|a tolerance of|the integrator) (\S+) ?s? reaches the end of the scene")
INACCURATE_REMEDY = "reaches the end of the scene, but the error of its energy balance is"
REMEDY_OPTIONS = {"a step of": "--step", "a tolerance of": "--tolerance", "the integrator": "--integrator"}


def run(program, scene_file, folder, seconds, *options):
    """Runs a scene; returns the exit code and the text of the program."""
    command = [program, "run", scene_file, "-o", folder, "--force", *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        text, _ = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
        try:
            text, _ = process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            process.kill()
            return -signal.SIGKILL, "the program did not stop after an interrupt"
        if process.returncode == -signal.SIGINT:  # the scene was still being read
            return INTERRUPTED, text
    return process.returncode, text


def numbers_of(file):
    """Returns the float64 entries of an .npy file."""
    data = file.read_bytes()
    start = 10 + int.from_bytes(data[8:10], "little")
    values = array.array("d")
    values.frombytes(data[start:start + (len(data) - start) // 8 * 8])
    return values


def faults_of_files(folder):
    for name in ("t.npy", "q.npy", "v.npy"):
        file = folder / name
        if file.exists() and any(x - x != 0 for x in numbers_of(file)):
            yield f"{name} contains a number that is not finite"
    for name in ("trajectory.csv", "contacts.csv", "joint_impulses.csv", "run.json"):
        file = folder / name
        if file.exists() and re.search(r"(?<![a-z])-?(nan|inf)(?![a-z])", file.read_text()):
            yield f"{name} contains inf or nan"


def balance_share(folder):
    """Returns the largest error of the energy balance, from trajectory.csv, divided by the energy that could
    move (include/pliant/simulate/README.md)."""
    with open(folder / "trajectory.csv", newline="") as file:
        rows = [{key.split(" ")[0]: float(value) for key, value in row.items() if value}
                for row in csv.DictReader(file)]
    works = [[value for key, value in row.items() if key.startswith("work.")] for row in rows]
    total = [row["energy.total"] - sum(done) for row, done in zip(rows, works)]
    potential = [row["energy.total"] - row["energy.kinetic"] for row in rows]
    error = max(abs(difference - total[0]) for difference in total)
    movable = rows[0]["energy.kinetic"] + potential[0] - min(potential)
    movable += max(sum(map(abs, done)) for done in works)
    return error / movable if movable > 0 else 0


def faults_of_complete_run(folder, code):
    record = json.loads((folder / "run.json").read_text())
    monitors = record["monitors"]
    share = balance_share(folder)
    if monitors["balance_share"] == 0 or share * monitors["movable_energy"] < 1e-9:
        return  # nothing has moved
    if share > REPORTED_SHARE and not any("error of the energy balance" in note for note in record["notes"]):
        yield f"the balance error is {share:.3g} of the energy that could move, and no note reports it"
    order = ORDERS.get(record["options"]["integrator"], 1)
    if monitors["balance_share"] > (LARGEST_SHARE if order == 1 or code == INACCURATE else REPORTED_SHARE):
        yield f"the balance error of a method of order {order} is {share:.3g} of the energy that could move"


def faults_of_failure(program, scene_file, folder, text, seconds):
    message = next((line for line in text.splitlines() if "error:" in line), "")
    if not re.search("(part|parts|ball|rod|string|plane|line|hinge|slider|weld|joint) '|p[0-9]+[.]", message):
        yield f"the message names neither part nor joint: {message}"
    if not re.search(r"at t = |before time 0|at time 0", message):
        yield f"the message has no time: {message}"
    remedy = REMEDY.search(message)
    if remedy:
        code, again = run(program, scene_file, folder / "again", 10 * seconds, REMEDY_OPTIONS[remedy[1]], remedy[2])
        expected = (DONE, INACCURATE, INTERRUPTED) if INACCURATE_REMEDY in message else (DONE, INTERRUPTED)
        if code not in expected:
            yield f"the remedy '{remedy[0]}' ends with code {code}: {again.splitlines()[-1]}"


def examine(program, seed, seconds):
    """Returns the outcome of a seed and its faults."""
    with tempfile.TemporaryDirectory() as place:
        scene_file, folder = pathlib.Path(place, "scene.json"), pathlib.Path(place, "out")
        scene_file.write_text(json.dumps(random_scene(seed)))
        code, text = run(program, scene_file, folder, seconds)
        faults = list(faults_of_files(folder))
        if code in (DONE, INACCURATE):
            faults += faults_of_complete_run(folder, code)
        elif code in (UNSATISFIABLE, NUMERICAL):
            faults += faults_of_failure(program, scene_file, folder, text, seconds)
        elif code == BAD_SCENE:
            faults += [] if REFUSALS.search(text) else [f"refused: {text}"]
        elif code != INTERRUPTED:
            faults.append(f"exit code {code}: {text[-500:]}")
        return code, faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int)
    parser.add_argument("--seconds", type=float, default=20, help="longest wall time of a scene")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    seeds = range(arguments.first, arguments.last + 1)
    outcomes, faulty = collections.Counter(), 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        results = pool.map(lambda seed: examine(arguments.program, seed, arguments.seconds), seeds)
        for seed, (code, faults) in zip(seeds, results):
            outcomes[code] += 1
            faulty += bool(faults)
            for fault in faults:
                print(f"scene {seed}: {fault}", flush=True)
    names = {DONE: "complete", BAD_SCENE: "refused", UNSATISFIABLE: "joints contradict each other",
             NUMERICAL: "numerical failure", INACCURATE: "inaccurate", INTERRUPTED: "slow"}
    print(", ".join(f"{names.get(code, f'exit code {code}')} {count}" for code, count in sorted(outcomes.items())))
    print(f"{faulty} of {len(seeds)} scenes have faults")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
