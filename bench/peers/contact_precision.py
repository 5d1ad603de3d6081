#!/usr/bin/env python3
"""Measures run time against error of contact, in pliant and in other engines, with one thread.

usage: contact_precision.py FOLDER --program build/release/bench/scene_states [--engines pliant,mujoco,bullet,rapier]
                            [--problems block,drop,slide,bowl,heap] [--rounds 3] [--limit 3]

Writes contact_precision.csv and contact_reference.csv to FOLDER. The engines run in alternation, setting by setting, so
that other load of the machine affects all engines equally.
"""
import argparse
import csv
import importlib
import importlib.metadata
import multiprocessing
import os
import time
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import numpy as np

import contact_problems
import pliant_contact
import sliding_rods
from contact_judge import judge

PEERS = "mujoco bullet rapier".split()
COLUMNS = "problem,engine,method,setting,cpu_s,median_error_m,max_error_m,depth_m,energy_error,failed".split(",")
TOLERANCES = 1e-2, 1e-3, 1e-4, 1e-5, 1e-6  # of pliant
# The reference: pliant simulates each body alone, with this method and tolerance. Other runs of pliant confirm the
# reference: (method, kind of setting, tolerance or step in s).
REFERENCE = "dop853", 1e-7
CONFIRMED_BY = ("dop853", "tolerance", 1e-6), ("rk4", "step", 0.02 / 2**8), ("rk4", "step", 0.02 / 2**9)


def simulate(engine, name, step):
    """Simulates a problem in an engine, in the process of the engine. step: s. Returns (CPU s, samples)."""
    problem = contact_problems.make(name)
    advance, sample = importlib.import_module(f"{engine}_contact").make(problem, step)
    steps, seconds, samples = round(pliant_contact.INTERVAL / step), 0, [sample()]
    for _ in range(round(problem.end / pliant_contact.INTERVAL)):
        start = time.process_time()
        advance(steps)
        seconds += time.process_time() - start
        samples.append(sample())
    return seconds, np.array(samples)


def version(engine):
    return importlib.metadata.version(importlib.import_module(f"{engine}_contact").DISTRIBUTION)


class Peer:
    """An engine in a process of its own."""

    def __init__(self, engine):
        self.engine, self.pool = engine, None
        self.version = self.call(version, engine)

    def call(self, function, *arguments):
        if self.pool is None:
            self.pool = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
        try:
            return self.pool.submit(function, *arguments).result()
        except BrokenProcessPool:
            self.pool = None
            raise

    def run(self, problem, method, setting):
        return self.call(simulate, self.engine, problem.name, setting)

    def settings(self, problem):
        return [("step", pliant_contact.INTERVAL / 2**k) for k in range(problem.finest + 1)]


class Pliant:
    def __init__(self, program, folder):
        self.program, self.folder, self.version = program, folder, "of this repository"

    def run(self, problem, method, setting):
        kind, name = ("step", "rk4") if method == "step" else ("tolerance", "auto")
        scene = pliant_contact.write_scene(problem, self.folder)
        return pliant_contact.run(self.program, scene, name, kind, setting, len(problem.bodies))

    def settings(self, problem):
        steps = [("step", pliant_contact.INTERVAL / 2**k) for k in range(problem.finest + 1)]
        return steps + [("tolerance", tolerance) for tolerance in TOLERANCES]

    def places_alone(self, problem, method, kind, value):
        """Simulates each body alone, and returns the centres at the end."""
        places = []
        for body in problem.bodies:
            scene = pliant_contact.write_scene(problem, self.folder, [body])
            places.append(pliant_contact.run(self.program, scene, method, kind, value, 1)[1][-1, 0, :3])
        return np.array(places)


def reference(problem, pliant, table):
    """Returns the centres at the end, or None if bodies meet. Writes the differences of the methods to the table."""
    if problem.meet:
        return None
    if problem.name == "block":
        return contact_problems.sliding_block(problem.end)[0][None]
    places = pliant.places_alone(problem, REFERENCE[0], "tolerance", REFERENCE[1])

    def compare(method, kind, value, others, which):
        difference = np.linalg.norm(others - places[which], axis=1)
        table.writerow([problem.name, method, kind, f"{value:.6g}", f"{np.median(difference):.2e}", f"{difference.max():.2e}"])

    for method, kind, value in CONFIRMED_BY:
        compare(method, kind, value, pliant.places_alone(problem, method, kind, value), slice(None))
    if problem.name == "slide":
        rods, others = sliding_rods.places(problem)
        compare("sliding_rods.py", "regularisation", sliding_rods.REGULARISATION, others, rods)
    return places


def interleaved(problem, engines):
    """Returns all runs (engine, method, setting) of a round: the first setting of each engine, then the second, ..."""
    lists = [[(name, *setting) for setting in engine.settings(problem)] for name, engine in engines.items()]
    return [runs[i] for i in range(max(map(len, lists))) for runs in lists if i < len(runs)]


def measure(problem, engines, places, rounds, limit):
    """Returns {(engine, method, setting): [least CPU s, result of judge()]}.

    For a failed run, the message of the failure replaces the result of judge(). limit: after a run of more CPU seconds than
    this limit, finer settings of the same method are not measured.
    """
    times = np.arange(round(problem.end / pliant_contact.INTERVAL) + 1) * pliant_contact.INTERVAL
    results, too_long, plan = {}, set(), interleaved(problem, engines)
    for run in plan:
        name, method, setting = run
        if (name, method) in too_long:
            continue
        try:
            seconds, samples = engines[name].run(problem, method, setting)
            results[run] = [seconds, judge(problem, times, samples, places)]
            if seconds > limit:
                too_long.add((name, method))
        except Exception as fault:  # any exception of an engine is a failed run
            results[run] = [np.nan, str(fault).split("\n")[0]]
    for _ in range(rounds - 1):
        for run in plan:
            if run in results and not isinstance(results[run][1], str):
                name, method, setting = run
                results[run][0] = min(results[run][0], engines[name].run(problem, method, setting)[0])
    return results


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--program", type=Path, required=True, help="path of scene_states")
    parser.add_argument("--engines", type=lambda s: s.split(","), default=["pliant", *PEERS])
    parser.add_argument("--problems", type=lambda s: s.split(","), default=contact_problems.NAMES)
    parser.add_argument("--rounds", type=int, default=3, help="runs per setting; the least time is written")
    parser.add_argument("--limit", type=float, default=3,
                        help="CPU seconds; after a longer run, finer settings of its method are skipped")
    return parser.parse_args()


def installed(options, pliant):
    engines = {}
    for name in options.engines:
        try:
            engines[name] = pliant if name == "pliant" else Peer(name)
        except (ImportError, importlib.metadata.PackageNotFoundError) as fault:
            print(f"{name}: SKIPPED, {fault}", flush=True)
    return engines


def main():
    options = arguments()
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"):
        os.environ[variable] = "1"
    scenes = options.folder / "scenes"
    scenes.mkdir(parents=True, exist_ok=True)
    pliant = Pliant(options.program.resolve(), scenes.resolve())
    engines = installed(options, pliant)
    with open(options.folder / "contact_precision.csv", "w", newline="") as file, \
            open(options.folder / "contact_reference.csv", "w", newline="") as other:
        file.write("# " + ", ".join(f"{name} {engine.version}" for name, engine in engines.items()) + "\n")
        table, references = csv.writer(file, lineterminator="\n"), csv.writer(other, lineterminator="\n")
        table.writerow(COLUMNS)
        references.writerow(["problem", "method", "kind", "setting", "median_difference_m", "max_difference_m"])
        for name in options.problems:
            problem = contact_problems.make(name)
            places = reference(problem, pliant, references)
            results = measure(problem, engines, places, options.rounds, options.limit)
            for (engine, method, setting), (seconds, found) in results.items():
                failed = isinstance(found, str)
                numbers = [""] * 5 if failed else [f"{seconds:.5f}", *(f"{x:.3e}" if np.isfinite(x) else "" for x in found)]
                table.writerow([name, engine, method, f"{setting:.6g}", *numbers, int(failed)])
                print(name, engine, method, f"{setting:.6g}", *numbers, found if failed else "", flush=True)


if __name__ == "__main__":
    main()
