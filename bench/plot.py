#!/usr/bin/env python3
"""Draws the CSV of bench/work_error as run time against error, one panel a problem.

usage: work_error > work_error.csv; bench/plot.py work_error.csv work_error.svg   (needs matplotlib)
"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def main() -> None:
    source, target = sys.argv[1:3]
    with open(source, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    problems = list(dict.fromkeys(row["problem"] for row in rows))
    figure, panels = plt.subplots(1, len(problems), figsize=(5 * len(problems), 4), squeeze=False)
    for panel, problem in zip(panels[0], problems):
        for method in dict.fromkeys(row["method"] for row in rows):
            points = [r for r in rows if r["problem"] == problem and r["method"] == method]
            panel.loglog([float(r["error"]) for r in points], [float(r["cpu_ms"]) for r in points], "o-", label=method)
        panel.set(title=problem, xlabel="error at the end", ylabel="run time, ms")
        panel.invert_xaxis()
        panel.grid(True, which="major", alpha=0.3)
        panel.legend()
    figure.tight_layout()
    figure.savefig(target)


if __name__ == "__main__":
    main()
