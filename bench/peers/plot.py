#!/usr/bin/env python3
"""Draws the curves of pliant and of the peers, one panel per problem, and tabulates the best time of each engine.

usage: plot.py PEERS.csv PLIANT.csv FOLDER

PLIANT.csv: work_precision.csv of work_precision (columns problem, method, cpu_ms_per_s, error). Writes
FOLDER/peers.png and FOLDER/peers_table.csv: CPU ms per simulated second of the cheapest run with at most each error level.
A run qualifies for a level only if the errors of the next two finer runs are at most 3 times its own error.
"""
import csv
import math
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

LEVELS = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10)
COLUMNS = 3
NO_ENGINE = "multipliers"  # is drawn and tabulated, but not compared with pliant, because it belongs to no engine


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def curves(peers, pliant):
    """Returns {problem: {(engine, formulation, method): [(error, CPU ms per s), from coarse to fine]}}; NaN for failed runs."""
    result = {}
    for row in peers:
        key = row["engine"], row["formulation"], row["method"]
        points = result.setdefault(row["problem"], {}).setdefault(key, [])
        points.append((math.nan, math.nan) if row["failed"] == "1"
                  else (float(row["error"]), float(row["cpu_ms_per_s"])))
    for row in pliant:
        if row["problem"] in result:
            points = result[row["problem"]].setdefault(("pliant", "", row["method"]), [])
            points.append((float(row["error"] or math.nan), float(row["cpu_ms_per_s"] or math.nan)))
    return result


def time_at(points, level):
    """Returns the minimum time of the runs that qualify for a level, or infinity. Failed runs are ignored."""
    min_time, points = math.inf, [p for p in points if not math.isnan(p[0])]
    for i, (error, time) in enumerate(points):
        finer = points[i + 1 : i + 3]
        if error <= level and all(e <= 3 * error for e, _ in finer):
            min_time = min(min_time, time)
    return min_time


def table(problem, by_method):
    """Returns a row for each engine (problem, engine, time and method at each level), and a row of ratios.

    A ratio is the best time of a peer divided by the best time of pliant.
    """
    rows, best = [], {}
    for engine in dict.fromkeys(key[0] for key in by_method):
        cells = []
        for level in LEVELS:
            time, name = min((time_at(points, level), " ".join(filter(None, key[1:])))
                             for key, points in by_method.items() if key[0] == engine)
            best[engine, level] = time
            cells += [f"{time:.3g}", name] if math.isfinite(time) else ["", ""]
        rows.append([problem, engine, *cells])
    ratios = []
    for level in LEVELS:
        peer = min((t for (e, l), t in best.items() if l == level and e not in ("pliant", NO_ENGINE)), default=math.inf)
        own = best.get(("pliant", level), math.inf)
        ratios += [f"{peer / own:.2f}" if math.isfinite(peer) and math.isfinite(own) else "", ""]
    return rows + [[problem, "best peer / pliant", *ratios]]


def draw(by_problem, target):
    engines = list(dict.fromkeys(key[0] for methods in by_problem.values() for key in methods))
    engines.sort(key=lambda engine: engine != "pliant")
    colours = {engine: "black" if engine == "pliant" else f"C{i - 1}" for i, engine in enumerate(engines)}
    n_rows = math.ceil(len(by_problem) / COLUMNS)
    figure, panels = plt.subplots(n_rows, COLUMNS, figsize=(5 * COLUMNS, 4 * n_rows), squeeze=False)
    for panel in panels.flat[len(by_problem):]:
        panel.set_axis_off()
    for panel, (problem, by_method) in zip(panels.flat, by_problem.items()):
        for engine in engines:
            keys = [key for key in by_method if key[0] == engine]
            for marker, key in zip("osv^Dx+*", keys):
                points = [p for p in by_method[key] if math.isfinite(p[0]) and p[0] > 0]
                panel.loglog(*zip(*points) if points else ([], []), marker + "-", ms=3, color=colours[engine],
                             lw=1.6 if engine == "pliant" else 0.8)
        present = {key[0] for key in by_method}
        failed = present - {key[0] for key, points in by_method.items() if any(math.isfinite(e) for e, _ in points)}
        note = f" (only failed runs: {', '.join(sorted(failed))})" if failed else ""
        panel.set(title=problem + note, xlabel="error at the end", ylabel="CPU ms per simulated s", xlim=(10, 1e-11))
        panel.grid(True, which="major", alpha=0.3)
    handles = [plt.Line2D([], [], color=colour) for colour in colours.values()]
    figure.legend(handles, colours, loc="upper center", ncols=len(colours))
    figure.tight_layout(rect=(0, 0, 1, 1 - 0.15 / n_rows))
    figure.savefig(target)


def main():
    peers, pliant, folder = sys.argv[1:4]
    by_problem = curves(read(peers), read(pliant))
    draw(by_problem, Path(folder) / "peers.png")
    with open(Path(folder) / "peers_table.csv", "w", newline="") as file:
        table_file = csv.writer(file, lineterminator="\n")
        table_file.writerow(["problem", "engine", *(x for level in LEVELS for x in (f"ms_per_s_at_{level:g}", "by"))])
        for problem, by_method in by_problem.items():
            for row in table(problem, by_method):
                table_file.writerow(row)
                print(f"{row[0]:5} {row[1]:20}" + "".join(f"{t or '-':>9} {by:28}" for t, by in zip(row[2::2], row[3::2])))


if __name__ == "__main__":
    main()
