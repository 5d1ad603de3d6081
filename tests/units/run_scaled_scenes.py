"""Runs scenes in several systems of units and compares the recorded motions bit for bit.

Floating-point arithmetic commutes with scaling by powers of two. A difference therefore means that a number with a
unit, for example a smallest length in metres, is hidden in the program, or that numbers of different units are
compared.

Without names, all scenes of cases.py run, and the shipped scenes for a short time. A name is a scene of
cases.py, "seed7" for the scene 7 of fuzz/random_scene.py, or a scene file.
"""

import argparse
import concurrent.futures
import json
import math
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SCENES = HERE.parent.parent / "scenes"
sys.path.append(str(HERE.parent / "fuzz"))

from cases import all_cases  # noqa: E402
from random_scene import random_scene  # noqa: E402
from run_random_scenes import numbers_of  # noqa: E402
from scale_scene import Units, scale_scene, size_of_unit  # noqa: E402

# Systems of units, with the largest difference of a number that is accepted, relative to the largest number of its
# table. In the first two systems, none of the units of speed, acceleration, force, energy, momentum and pressure is 1.
# The third system multiplies masses by an odd power of two. This changes the rounding of square roots of masses, and
# therefore Cholesky factors, inverse scales and modes, whose signs may change. Contact at many nodes amplifies the
# changes. Only scenes of cases.py without modes run in the third system.
EXACT = [(Units(2.0**9, 2.0**-8, 2.0**4), 0), (Units(2.0**-6, 2.0**14, 2.0**-7), 0)]
ODD_MASS = [(Units(1, 2.0**7, 1), 1e-10)]
SINGLE = [(units, 0) for units in (Units(2.0**9, 1, 1), Units(2.0**-10, 1, 1), Units(1, 2.0**-8, 1),
                                   Units(1, 2.0**8, 1), Units(1, 1, 2.0**-6), Units(1, 1, 2.0**7))]


def scene_of(name, cases, end):
    """Returns the scene with a name. Random and shipped scenes end at the time `end` (s) at the latest."""
    if name in cases:
        return cases[name]
    if name.startswith("seed"):
        scene = random_scene(int(name[4:]))
    else:
        file = pathlib.Path(name)
        scene = json.loads(file.read_text())
        for obstacle in scene.get("contact", {}).get("obstacles", []):
            if "mesh" in obstacle:
                obstacle["mesh"] = str((file.parent / obstacle["mesh"]).resolve())
    time = scene.setdefault("time", {})
    time["end"] = min(time.get("end", 1), end)
    return scene


def systems_of(name, cases):
    return EXACT + (ODD_MASS if name in cases and name != "solid_modes" else [])


def columns_of(entries, layout, owner="*"):
    """Returns the names and units of the columns of a table, in order. entries: entry of the table in layout.json."""
    columns = []
    for entry in entries:
        if "each" in entry:
            for name, kind, *_ in layout[entry["each"]]:
                columns += columns_of(layout["kinds"][kind][entry["columns"]], layout, name)
        else:
            numbers = range(entry["count"]) if "count" in entry else [""]
            columns += [(entry["name"].replace("#", str(k)).replace("*", owner), entry["unit"]) for k in numbers]
    return columns


class Run:
    """A finished run: its exit code, its last line, and its tables with the units of their columns."""

    def __init__(self, program, scene, folder, seconds):
        folder.mkdir()
        file, out = folder / "scene.json", folder / "out"
        file.write_text(json.dumps(scene))
        command = [program, "run", file, "-o", out, "--quiet"]
        try:
            process = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                     timeout=seconds)
            self.code, self.text = process.returncode, process.stdout.strip()
        except subprocess.TimeoutExpired:
            self.code, self.text = None, f"not finished after {seconds} s"
        self.tables = {}
        if (out / "layout.json").exists():
            layout = json.loads((out / "layout.json").read_text())
            self.tables = {name: (columns_of(layout["tables"][name], layout), numbers_of(out / name))
                           for name in ("t.npy", "q.npy", "v.npy")}


def difference(plain, other, units, bound):
    """Describes the largest difference of two runs, relative to the largest number of the table. Returns None if the
    difference is at most `bound`."""
    if plain.code != other.code or plain.code is None:
        return f"exit codes {plain.code} and {other.code}: {plain.text[-300:]} | {other.text[-300:]}"
    largest, place, first = 0, None, None
    for name, (columns, numbers) in plain.tables.items():
        changed = other.tables[name][1]
        if len(numbers) != len(changed):
            return f"{name} has {len(numbers) // len(columns)} and {len(changed) // len(columns)} rows"
        sizes = [size_of_unit(unit, units) for _, unit in columns]
        scale = max(map(abs, numbers), default=0) or 1
        if not all(map(math.isfinite, [*numbers, *changed])):
            return f"{name} contains numbers that are not finite"
        for i, (x, y) in enumerate(zip(numbers, changed)):
            y /= sizes[i % len(columns)]
            if x == y:
                continue
            first = min(first, i // len(columns)) if first is not None else i // len(columns)
            if abs(x - y) >= largest * scale:
                largest, place = abs(x - y) / scale, columns[i % len(columns)][0]
    if place is None or 0 < largest <= bound:
        return None
    return f"{largest:.2g} at {place}, from row {first} on"


def examine(program, scene, systems, seconds, must_end):
    """Returns the faults of a scene, one line for each system of units that changes its motion. must_end: whether a
    failure is a fault even if it is the same in all systems."""
    with tempfile.TemporaryDirectory() as place:
        plain = Run(program, scale_scene(scene, Units(1, 1, 1)), pathlib.Path(place, "plain"), seconds)
        if must_end and plain.code not in (0, 6):  # 6: complete, with a large error of the energy balance
            yield f"exit code {plain.code}: {plain.text[-300:]}"
        for number, (units, bound) in enumerate(systems):
            other = Run(program, scale_scene(scene, units), pathlib.Path(place, str(number)), seconds)
            found = difference(plain, other, units, bound)
            if found is not None:
                yield f"lengths x {units.length}, masses x {units.mass}, times x {units.time}: {found}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--single", action="store_true", help="change one unit at a time")
    parser.add_argument("--end", type=float, default=0.06, help="longest simulated time of shipped and random scenes")
    parser.add_argument("--seconds", type=float, default=20, help="longest wall time of a run")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    cases = all_cases()
    shipped = sorted(str(file) for file in SCENES.glob("*.json") if "schema" not in file.name)
    names = arguments.names or [*cases, *shipped]
    faulty = 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        results = pool.map(
            lambda name: list(examine(arguments.program, scene_of(name, cases, arguments.end),
                                      SINGLE if arguments.single else systems_of(name, cases),
                                      arguments.seconds, not name.startswith("seed"))), names)
        for name, faults in zip(names, results):
            faulty += bool(faults)
            for fault in faults:
                print(f"{pathlib.Path(name).stem}: {fault}", flush=True)
    print(f"{len(names) - faulty} of {len(names)} scenes move alike in all units")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
