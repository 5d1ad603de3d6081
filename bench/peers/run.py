#!/usr/bin/env python3
"""Runs the problems in every installed engine with one thread, and writes run time against error.

usage: run.py FOLDER [--out peers.csv] [--quick] [--problems A,B] [--engines mujoco,simbody] [--limit SECONDS]
              [--again]
"""
import argparse
import csv
import importlib
import importlib.metadata
import math
import multiprocessing
import os
import signal
import sys
import time
from pathlib import Path

import errors
import native_peer
import problems

ENGINES = "pinocchio mujoco simbody exudyn drake multipliers".split()
QUICK = "A B C8 D4".split()
REFERENCES = Path(__file__).resolve().parents[1] / "results" / "amd_epyc_portable" / "precision_reference.csv"
RUN = "problem,engine,formulation,method,step_or_tolerance,error".split(",")
COLUMNS = "problem,engine,formulation,method,step_or_tolerance,cpu_ms,cpu_ms_per_s,error,failed".split(",")
# The settings of a method, from coarse to fine, are its ladder. A ladder ends after
# - an error below SMALLEST,
# - STALLED successive runs with errors below ROUNDING, none of which is smaller than all earlier errors of the ladder,
# - FAILURES failed runs,
# - a failed run that ends more than 4 times the time limit after the start of the ladder,
# - a run that crashed or was killed,
# - a run of more than half the time limit, or
# - a run of more than a 16th of the limit that is DOMINATED times slower than another run whose error is not larger.
SMALLEST, ROUNDING, STALLED = 1e-10, 1e-7, 3
FAILURES = 6
DOMINATED = 30


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path, help="folder for built programs and intermediate files")
    parser.add_argument("--out", type=Path, help="default: FOLDER/peers.csv")
    parser.add_argument("--quick", action="store_true",
                        help=f"only the problems {' '.join(QUICK)}, with a limit of 1 s")
    parser.add_argument("--problems", type=lambda s: s.split(","), help="default: all")
    parser.add_argument("--engines", type=lambda s: s.split(","), default=ENGINES)
    parser.add_argument("--limit", type=float, help="time limit of a run, s (default: 10, or 1 with --quick); a run is "
                        "killed after 4 times this limit")
    parser.add_argument("--again", action="store_true", help="add a round: rows in --out of other problems and "
                        "engines are preserved; of equal runs the smaller time is written")
    parser.add_argument("--prefix", default=sys.prefix, help="Python environment whose wheels contain native libraries")
    parser.add_argument("--references", type=Path, default=REFERENCES)
    return parser.parse_args()


def ladders(engine, name, folder):
    return list(importlib.import_module(f"{engine}_peer").ladders(problems.problem(name), folder))


def titles(engine, name, folder):
    return [ladder[:3] for ladder in ladders(engine, name, folder)]


def version(engine, folder):
    peer = importlib.import_module(f"{engine}_peer")
    if getattr(peer, "PROGRAM", None) and not (folder / "native" / peer.PROGRAM).exists():
        raise RuntimeError(f"{peer.PROGRAM} was not built: its library was not found")
    return importlib.metadata.version(peer.DISTRIBUTION) if peer.DISTRIBUTION else "of the system"


def read_rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def in_child(function, *args):
    """Calls function(*args) in a new process and returns its result: engines are loaded only in separate processes."""
    with multiprocessing.Pool(1) as pool:
        return pool.apply(function, args)


def available(engine, folder):
    """Returns the version of an engine. If it cannot be loaded, prints a message and returns None."""
    try:
        return in_child(version, engine, folder)
    except Exception as fault:  # any error of loading
        print(f"{engine}: SKIPPED, {fault}", flush=True)
        return None


def serve(connection, engine, name, folder, index):
    """Runs in a separate process: receives settings of one ladder and sends the results of their runs."""
    os.setsid()  # a new process group, so that the parent can kill this process with all its child processes
    run = ladders(engine, name, folder)[index][3]
    while True:
        setting = connection.recv()
        try:
            connection.send(run(setting))
        except Exception as fault:  # any exception of an engine is a failed run
            connection.send(str(fault) or type(fault).__name__)


def runs(engine, name, folder, index, settings, limit):
    """Yields (setting, result), from coarse to fine. result: (CPU s, centres, quaternions), or the reason of a failure."""
    parent_end, child_end = multiprocessing.Pipe()
    process = multiprocessing.Process(target=serve, args=(child_end, engine, name, folder, index))
    process.start()
    child_end.close()
    try:
        for setting in settings:
            parent_end.send(setting)
            if not parent_end.poll(4 * limit):
                yield setting, f"killed after {4 * limit:g} s"
                return
            try:
                result = parent_end.recv()
            except EOFError:
                yield setting, "crashed"
                return
            yield setting, result
    finally:
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            process.kill()
        process.join()


def measure(problem, engine, folder, reference, smallest, limit, best, min_times, write):
    """Measures all ladders of an engine on a problem.

    smallest: smaller errors are replaced by this error; best: (CPU s, error) of the runs of all engines so far, to which
    the new runs are added; min_times: CPU ms of the runs of earlier rounds; write(row, remark): writes a row.
    """
    for index, (formulation, method, settings) in enumerate(in_child(titles, engine, problem.name, folder)):
        failures, ladder_errors, start = 0, [], time.monotonic()
        for setting, result in runs(engine, problem.name, folder, index, settings, limit):
            seconds, error, reason = math.nan, math.nan, result
            if not isinstance(result, str):
                seconds, *pose = result
                error, reason = max(errors.error(problem, pose, reference), smallest), "not finite"
            failed = math.isnan(error)
            key = [problem.name, engine, formulation, method, f"{setting:.6g}"]
            if failed:
                write(key + ["", "", "", 1], reason.strip().split("\n")[0][:100])
                failures += 1
                if failures >= FAILURES or time.monotonic() - start > 4 * limit:
                    break
                continue
            error_text = f"{error:.3e}"
            seconds = min(seconds, min_times.get((*key, error_text), math.inf) / 1e3)
            write(key + [f"{seconds * 1e3:.4f}", f"{seconds * 1e3 / problem.end:.4f}", error_text, 0], "")
            ladder_errors.append(error)
            best.append((seconds, error))
            dominated = seconds > limit / 16 and any(seconds > DOMINATED * s and error >= e for s, e in best)
            last = ladder_errors[-STALLED:]
            stalled = (len(ladder_errors) > STALLED and max(last) < ROUNDING
                       and min(last) >= min(ladder_errors[:-STALLED]))
            if error < SMALLEST or seconds > limit / 2 or dominated or stalled:
                break


def main():
    options = arguments()
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[variable] = "1"
    multiprocessing.set_start_method("spawn")
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    native_peer.build(folder / "native", options.prefix)
    references = errors.read_references(options.references)
    resolutions = errors.read_resolutions(options.references)
    limit = options.limit or (1 if options.quick else 10)
    names = options.problems or (QUICK if options.quick else list(problems.MAKERS))
    engines = {engine: found for engine in options.engines if (found := available(engine, folder))}
    out = options.out or folder / "peers.csv"
    earlier = read_rows(out) if options.again and out.exists() else []
    min_times = {tuple(row[column] for column in RUN): float(row["cpu_ms"]) for row in earlier if row["cpu_ms"]}
    with open(out, "w", newline="") as file:
        file.write("# " + ", ".join(f"{engine} {found}" for engine, found in engines.items()) + "\n")
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for row in earlier:
            if row["problem"] not in names or row["engine"] not in engines:
                table.writerow(row[column] for column in COLUMNS)

        def write(row, remark):
            table.writerow(row)
            file.flush()
            print(*row, remark, flush=True)

        for name in names:
            best = []
            for engine in engines:
                measure(problems.problem(name), engine, folder, references[name], resolutions[name], limit, best,
                        min_times, write)


if __name__ == "__main__":
    main()
