#!/usr/bin/env python3
"""Draws the CSV of bench/work_precision as run time, or evaluations, against error, one panel a problem.

Failed runs are crosses in the lower left corner, in the colour of their method. Of --of gap_m and balance_J the unit is that
of the name; the errors are those of positions, of velocities and of the forces of joints, relative.

usage: work_precision FOLDER; bench/plot.py FOLDER/work_precision.csv work_precision.svg   (needs matplotlib)
"""
import argparse
import csv
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

WIDEST = 4  # panels beside each other
FAR = 10  # an error, in body lengths, from which on a run has failed too
QUANTITIES = {
    "error": "error at the end",
    "error_along": "error along the way",
    "error_v": "error of velocities",
    "error_lambda": "error of forces",
    "gap_m": "widest gap, m",
    "balance_J": "error of the energy, J",
}
COSTS = {"cpu_ms": "run time, ms", "evaluations": "evaluations"}


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", help="work_precision.csv")
    parser.add_argument("target", help="picture to write; its ending tells the format")
    parser.add_argument("--of", choices=QUANTITIES, default="error", help="what lies across (default: error)")
    parser.add_argument("--cost", choices=COSTS, default="cpu_ms", help="what lies upwards (default: cpu_ms)")
    parser.add_argument("--problems", help="their names with commas between them (default: all)")
    return parser.parse_args()


def draw(panel, rows: list, quantity: str, cost: str, method: str, crosses: int) -> int:
    """One method's line in a panel, and its failed runs beside as many crosses of others; how many there are then."""
    done = [
        (float(r[quantity]), float(r[cost])) for r in rows if r["failed"] != "1" and float(r["error"]) < FAR
    ]
    points = [(x, y) for x, y in done if x > 0 and math.isfinite(x)]
    (line,) = panel.loglog([x for x, _ in points], [y for _, y in points], "o-", ms=4, label=method)
    failed = len(rows) - len(done)
    places = [0.02 + 0.03 * (crosses + i) for i in range(failed)]
    panel.plot(places, [0.03] * failed, "x", ms=5, color=line.get_color(), transform=panel.transAxes)
    return crosses + failed


def main() -> None:
    given = arguments()
    with open(given.source, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    problems = list(dict.fromkeys(row["problem"] for row in rows))
    if given.problems:
        unknown = [name for name in given.problems.split(",") if name not in problems]
        if unknown:
            raise SystemExit(f"{given.source} has no problem {', '.join(unknown)}; it has {', '.join(problems)}")
        problems = given.problems.split(",")
    methods = list(dict.fromkeys(row["method"] for row in rows))
    columns = min(len(problems), WIDEST)
    lines = math.ceil(len(problems) / columns)
    size = (5, 4) if len(problems) <= WIDEST else (3.5, 3)
    figure, panels = plt.subplots(lines, columns, figsize=(size[0] * columns, size[1] * lines), squeeze=False)
    for index, panel in enumerate(panels.flat):
        if index >= len(problems):
            panel.set_axis_off()
            continue
        crosses = 0
        for method in methods:
            of_method = [r for r in rows if r["problem"] == problems[index] and r["method"] == method]
            crosses = draw(panel, of_method, given.of, given.cost, method, crosses)
        panel.set(title=problems[index])
        if index + columns >= len(problems):
            panel.set(xlabel=QUANTITIES[given.of])
        if index % columns == 0:
            panel.set(ylabel=COSTS[given.cost])
        panel.invert_xaxis()
        panel.grid(True, which="major", alpha=0.3)
        if lines == 1:
            panel.legend()
    if lines > 1:
        figure.legend(*panels[0][0].get_legend_handles_labels(), loc="upper center", ncols=min(len(methods), 5))
    figure.tight_layout(rect=(0, 0, 1, 1 if lines == 1 else 0.94))
    figure.savefig(given.target)


if __name__ == "__main__":
    main()
