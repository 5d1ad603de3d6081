#!/usr/bin/env python3
"""Draws pliant's curves and the peers' on one figure, a panel a problem, and tables the best of each engine.

usage: plot.py PEERS.csv PLIANT.csv FOLDER

PLIANT.csv: of work_precision (columns problem, method, cpu_ms_per_s, error). Writes
FOLDER/peers.png and FOLDER/peers_table.csv: CPU ms per simulated second at each error. A run counts at an error
only if neither of the next two finer ones is 3 times worse.
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
NO_ENGINE = "multipliers"  # drawn and tabled, but no peer


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def curves(peers, pliant):
    """{problem: {(engine, formulation, method): [(error, time) coarse to fine]}}; NaN for a failed run."""
    out = {}
    for row in peers:
        at = out.setdefault(row["problem"], {}).setdefault((row["engine"], row["formulation"], row["method"]), [])
        at.append((math.nan, math.nan) if row["failed"] == "1"
                  else (float(row["error"]), float(row["cpu_ms_per_s"])))
    for row in pliant:
        if row["problem"] in out:
            at = out[row["problem"]].setdefault(("pliant", "", row["method"]), [])
            at.append((float(row["error"] or math.nan), float(row["cpu_ms_per_s"] or math.nan)))
    return out


def time_at(points, level):
    """Least time of the runs that count at a level; infinite without. Failed runs are left out."""
    least, points = math.inf, [p for p in points if not math.isnan(p[0])]
    for i, (error, time) in enumerate(points):
        finer = points[i + 1 : i + 3]
        if error <= level and all(e <= 3 * error for e, _ in finer):
            least = min(least, time)
    return least


def table(problem, by_method):
    """Rows problem, engine, time at each level, method that takes it; then the ratio of best peer to pliant."""
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
    lines = math.ceil(len(by_problem) / COLUMNS)
    figure, panels = plt.subplots(lines, COLUMNS, figsize=(5 * COLUMNS, 4 * lines), squeeze=False)
    for panel in panels.flat[len(by_problem):]:
        panel.set_axis_off()
    for panel, (problem, by_method) in zip(panels.flat, by_problem.items()):
        for engine in engines:
            mine = [key for key in by_method if key[0] == engine]
            for marker, key in zip("osv^Dx+*", mine):
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
    figure.tight_layout(rect=(0, 0, 1, 1 - 0.15 / lines))
    figure.savefig(target)


def main():
    peers, pliant, folder = sys.argv[1:4]
    by_problem = curves(read(peers), read(pliant))
    draw(by_problem, Path(folder) / "peers.png")
    with open(Path(folder) / "peers_table.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["problem", "engine", *(x for level in LEVELS for x in (f"ms_per_s_at_{level:g}", "by"))])
        for problem, by_method in by_problem.items():
            for row in table(problem, by_method):
                out.writerow(row)
                print(f"{row[0]:5} {row[1]:20}" + "".join(f"{t or '-':>9} {by:28}" for t, by in zip(row[2::2], row[3::2])))


if __name__ == "__main__":
    main()
