#!/usr/bin/env python3
"""Draws run time, or the number of evaluations, against error from the CSV of bench/work_precision, one panel per problem.

Failed runs are crosses in the lower left corner, in the colour of their method. Errors decrease to the right. The unit of
gap_m is m, and the unit of balance_J is J. The errors of positions, of velocities and of joint forces are relative.

usage: work_precision FOLDER; bench/plot.py FOLDER/work_precision.csv work_precision.svg   (needs matplotlib)
"""
import argparse
import csv
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

MAX_COLUMNS = 4  # panels side by side
FAILED_ERROR = 10  # runs with at least this relative error are drawn as failed runs
QUANTITIES = {
    "error": "error at the end",
    "error_along": "largest error at eight times",
    "error_v": "error of velocities",
    "error_lambda": "error of forces",
    "gap_m": "widest gap, m",
    "balance_J": "error of the energy, J",
}
COSTS = {"cpu_ms": "run time, ms", "evaluations": "evaluations"}


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", help="work_precision.csv")
    parser.add_argument("target", help="picture file to write; its extension selects the format")
    parser.add_argument("--of", choices=QUANTITIES, default="error",
                        help="quantity on the horizontal axis (default: error)")
    parser.add_argument("--cost", choices=COSTS, default="cpu_ms",
                        help="quantity on the vertical axis (default: cpu_ms)")
    parser.add_argument("--problems", help="comma-separated names of problems (default: all)")
    return parser.parse_args()


def draw(panel, rows: list, quantity: str, cost: str, method: str, crosses: int) -> int:
    """Draws the line and the failed runs of one method in a panel that already contains `crosses` crosses.

    Returns the new number of crosses.
    """
    succeeded = [
        (float(r[quantity]), float(r[cost]))
        for r in rows
        if r["failed"] != "1" and float(r["error"]) < FAILED_ERROR
    ]
    points = [(x, y) for x, y in succeeded if x > 0 and math.isfinite(x)]
    (line,) = panel.loglog([x for x, _ in points], [y for _, y in points], "o-", ms=4, label=method)
    failed = len(rows) - len(succeeded)
    positions = [0.02 + 0.03 * (crosses + i) for i in range(failed)]
    panel.plot(positions, [0.03] * failed, "x", ms=5, color=line.get_color(), transform=panel.transAxes)
    return crosses + failed


def main() -> None:
    options = arguments()
    with open(options.source, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    problems = list(dict.fromkeys(row["problem"] for row in rows))
    if options.problems:
        unknown = [name for name in options.problems.split(",") if name not in problems]
        if unknown:
            raise SystemExit(f"{options.source} has no problem {', '.join(unknown)}; it has {', '.join(problems)}")
        problems = options.problems.split(",")
    methods = list(dict.fromkeys(row["method"] for row in rows))
    columns = min(len(problems), MAX_COLUMNS)
    n_rows = math.ceil(len(problems) / columns)
    size = (5, 4) if len(problems) <= MAX_COLUMNS else (3.5, 3)
    figure, panels = plt.subplots(n_rows, columns, figsize=(size[0] * columns, size[1] * n_rows), squeeze=False)
    for index, panel in enumerate(panels.flat):
        if index >= len(problems):
            panel.set_axis_off()
            continue
        crosses = 0
        for method in methods:
            method_rows = [r for r in rows if r["problem"] == problems[index] and r["method"] == method]
            crosses = draw(panel, method_rows, options.of, options.cost, method, crosses)
        panel.set(title=problems[index])
        if index + columns >= len(problems):
            panel.set(xlabel=QUANTITIES[options.of])
        if index % columns == 0:
            panel.set(ylabel=COSTS[options.cost])
        panel.invert_xaxis()
        panel.grid(True, which="major", alpha=0.3)
        if n_rows == 1:
            panel.legend()
    if n_rows > 1:
        figure.legend(*panels[0][0].get_legend_handles_labels(), loc="upper center", ncols=min(len(methods), 5))
    figure.tight_layout(rect=(0, 0, 1, 1 if n_rows == 1 else 0.94))
    figure.savefig(options.target)


if __name__ == "__main__":
    main()
