#!/usr/bin/env python3
"""Draws run time against error and against depth of contact, one panel per problem, and tabulates run times at given errors.

usage: contact_plot.py CONTACT_PRECISION.csv FOLDER

Writes FOLDER/contact_precision.png and FOLDER/contact_precision_table.csv. For each error level the table has the CPU
seconds of the cheapest run of each engine whose median error is at most this level. A run qualifies only if the errors of
all finer runs of its method are at most 3 times this level.
"""
import csv
import math
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

LEVELS = 5e-3, 1e-3, 2e-4, 5e-5  # m
LEAST_DEPTH = 1e-9  # m; smaller depths are drawn at this depth
COLOURS = {"pliant": "black", "mujoco": "C0", "bullet": "C1", "rapier": "C2"}


def read(path):
    """Returns {problem: {(engine, method): [(CPU s, median error, depth), from coarse to fine]}} without failed runs."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    curves = {}
    for row in rows:
        points = curves.setdefault(row["problem"], {}).setdefault((row["engine"], row["method"]), [])
        if row["failed"] == "0":
            points.append(tuple(float(row[name] or math.nan) for name in ("cpu_s", "median_error_m", "depth_m")))
    return curves


def time_at(points, level):
    """Returns the least time of the runs that qualify for an error level, or infinity."""
    best = math.inf
    for i, (seconds, error, _) in enumerate(points):
        if error <= level and all(finer <= 3 * level for _, finer, _ in points[i + 1:]):
            best = min(best, seconds)
    return best


def draw_panel(panel, by_method, column, title, xlabel):
    for (engine, method), points in by_method.items():
        line = "o-" if method == "step" else "s--"
        panel.loglog([max(point[column], LEAST_DEPTH) for point in points], [point[0] for point in points], line, ms=3,
                     lw=1, color=COLOURS[engine])
    panel.set(title=title, xlabel=xlabel)
    panel.invert_xaxis()
    panel.grid(True, which="major", alpha=0.3)


def draw(curves, target):
    compared = [name for name, methods in curves.items()
                if any(math.isfinite(point[1]) for points in methods.values() for point in points)]
    deep = [name for name in curves if name != "block"]
    columns = max(len(compared), len(deep))
    figure, panels = plt.subplots(2, columns, figsize=(3.2 * columns, 6), squeeze=False)
    for panel, name in zip(panels[0], compared):
        draw_panel(panel, curves[name], 1, name, "median error of places, m")
    for panel, name in zip(panels[1], deep):
        draw_panel(panel, curves[name], 2, name, "largest depth, m")
    for row, names in zip(panels, (compared, deep)):
        row[0].set_ylabel("CPU s")
        for panel in row[len(names):]:
            panel.set_axis_off()
    handles = [plt.Line2D([], [], color=colour) for colour in COLOURS.values()]
    handles += [plt.Line2D([], [], color="grey", ls=style) for style in ("-", "--")]
    figure.legend(handles, [*COLOURS, "fixed steps", "tolerance"], loc="upper center", ncols=len(handles))
    figure.tight_layout(rect=(0, 0, 1, 0.94))
    figure.savefig(target, dpi=80)


def tabulate(curves, path):
    with open(path, "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["problem", "engine", *(f"cpu_s_at_{level:g}_m" for level in LEVELS)])
        for problem, by_method in curves.items():
            for engine in dict.fromkeys(key[0] for key in by_method):
                times = [min(time_at(points, level) for key, points in by_method.items() if key[0] == engine)
                         for level in LEVELS]
                cells = [f"{seconds:.3g}" if math.isfinite(seconds) else "" for seconds in times]
                if any(cells):
                    table.writerow([problem, engine, *cells])
                    print(problem, engine, *(cell or "-" for cell in cells))


def main():
    source, folder = sys.argv[1:3]
    curves = read(source)
    draw(curves, Path(folder) / "contact_precision.png")
    tabulate(curves, Path(folder) / "contact_precision_table.csv")


if __name__ == "__main__":
    main()
