#!/usr/bin/env python3
"""Runs the problems in every engine that is installed, one thread, and writes run time against error.

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
# Nothing finer is run after an error below SMALLEST, after STALLED runs below ROUNDING that did not better the
# ladder's best, after FAILURES failed runs, after half the limit of time, or, of the runs above a 16th of it,
# after one DOMINATED times slower than another that is at least as good.
SMALLEST, ROUNDING, STALLED = 1e-10, 1e-7, 3
FAILURES = 6
DOMINATED = 30


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path, help="for what is built and written on the way")
    parser.add_argument("--out", type=Path, help="default: FOLDER/peers.csv")
    parser.add_argument("--quick", action="store_true", help=f"only {' '.join(QUICK)}, and a limit of 1 s")
    parser.add_argument("--problems", type=lambda s: s.split(","), help="default: all")
    parser.add_argument("--engines", type=lambda s: s.split(","), default=ENGINES)
    parser.add_argument("--limit", type=float, help="CPU s of one configuration, default 10; killed at 4 times that")
    parser.add_argument("--again", action="store_true", help="another round: what --out has of other problems and "
                        "engines stays, and of the same run the least time")
    parser.add_argument("--prefix", default=sys.prefix, help="where native libraries of wheels are looked for")
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
    """Engines are loaded in processes of their own only."""
    with multiprocessing.Pool(1) as pool:
        return pool.apply(function, args)


def available(engine, folder):
    """Its version, or None with a message."""
    try:
        return in_child(version, engine, folder)
    except Exception as fault:  # whatever keeps an engine from being loaded
        print(f"{engine}: SKIPPED, {fault}", flush=True)
        return None


def serve(connection, engine, name, folder, index):
    """In a process of its own: runs of one ladder, each asked for by the parent."""
    os.setsid()  # so that what it starts ends with it
    run = ladders(engine, name, folder)[index][3]
    while True:
        setting = connection.recv()
        try:
            connection.send(run(setting))
        except Exception as fault:  # whatever an engine throws is a failed run
            connection.send(str(fault) or type(fault).__name__)


def runs(engine, name, folder, index, settings, limit):
    """(setting, (seconds, centres, quaternions) or the reason of a failure), coarse to fine."""
    here, there = multiprocessing.Pipe()
    process = multiprocessing.Process(target=serve, args=(there, engine, name, folder, index))
    process.start()
    there.close()
    try:
        for setting in settings:
            here.send(setting)
            if not here.poll(4 * limit):
                yield setting, f"killed after {4 * limit:g} s"
                return
            try:
                result = here.recv()
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


def measure(problem, engine, folder, reference, smallest, limit, best, least, write):
    """All ladders of an engine on a problem; smallest: errors below count as that; best: (CPU s, error) of the runs
    so far; least: CPU ms of those of earlier rounds."""
    for index, (formulation, method, settings) in enumerate(in_child(titles, engine, problem.name, folder)):
        failures, mine, begin = 0, [], time.monotonic()
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
                if failures >= FAILURES or time.monotonic() - begin > 4 * limit:
                    break
                continue
            told = f"{error:.3e}"
            seconds = min(seconds, least.get((*key, told), math.inf) / 1e3)
            write(key + [f"{seconds * 1e3:.4f}", f"{seconds * 1e3 / problem.end:.4f}", told, 0], "")
            mine.append(error)
            best.append((seconds, error))
            dominated = seconds > limit / 16 and any(seconds > DOMINATED * s and error >= e for s, e in best)
            last = mine[-STALLED:]
            stalled = len(mine) > STALLED and max(last) < ROUNDING and min(last) >= min(mine[:-STALLED])
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
    references, smallest = errors.read_references(options.references), errors.read_least(options.references)
    limit = options.limit or (1 if options.quick else 10)
    names = options.problems or (QUICK if options.quick else list(problems.MAKERS))
    engines = {engine: found for engine in options.engines if (found := available(engine, folder))}
    out = options.out or folder / "peers.csv"
    earlier = read_rows(out) if options.again and out.exists() else []
    least = {tuple(row[column] for column in RUN): float(row["cpu_ms"]) for row in earlier if row["cpu_ms"]}
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
                measure(problems.problem(name), engine, folder, references[name], smallest[name], limit, best, least, write)


if __name__ == "__main__":
    main()
