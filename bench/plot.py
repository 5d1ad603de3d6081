#!/usr/bin/env python3
"""Draws the CSV of bench/work_precision as run time against error, one panel a problem.

usage: work_precision FOLDER; bench/plot.py FOLDER/work_precision.csv work_precision.svg   (needs matplotlib)
"""
import csv
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

WIDEST = 4  # panels beside each other


def main() -> None:
    source, target = sys.argv[1:3]
    with open(source, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    problems = list(dict.fromkeys(row["problem"] for row in rows))
    methods = list(dict.fromkeys(row["method"] for row in rows))
    columns = min(len(problems), WIDEST)
    lines = math.ceil(len(problems) / columns)
    size = (5, 4) if len(problems) <= WIDEST else (3.5, 3)
    figure, panels = plt.subplots(lines, columns, figsize=(size[0] * columns, size[1] * lines), squeeze=False)
    for index, panel in enumerate(panels.flat):
        if index >= len(problems):
            panel.set_axis_off()
            continue
        for method in methods:
            points = [
                r
                for r in rows
                if r["problem"] == problems[index] and r["method"] == method and r["failed"] != "1"
            ]
            errors = [float(r["error"]) for r in points]
            panel.loglog(errors, [float(r["cpu_ms"]) for r in points], "o-", ms=4, label=method)
        panel.set(title=problems[index])
        if index + columns >= len(problems):
            panel.set(xlabel="error at the end")
        if index % columns == 0:
            panel.set(ylabel="run time, ms")
        panel.invert_xaxis()
        panel.grid(True, which="major", alpha=0.3)
        if lines == 1:
            panel.legend()
    if lines > 1:
        figure.legend(*panels[0][0].get_legend_handles_labels(), loc="upper center", ncols=min(len(methods), 5))
    figure.tight_layout(rect=(0, 0, 1, 1 if lines == 1 else 0.94))
    figure.savefig(target)


if __name__ == "__main__":
    main()
