#!/usr/bin/env python3
"""Compares the reference poses, from which errors are measured, with the poses of a second method.

usage: references.py OUT.csv [PRECISION_REFERENCE.csv]

The second method for A is a Taylor series, with 20 and with 25 digits. For other problems
it computes the accelerations with exact multipliers
(multipliers_peer.py) with two tolerances. Columns: reference_difference: difference between the two methods of work_precision
that compute the reference; second_difference: difference between the two runs of the second method; agreement: difference
between the reference and the second method. errors.error() computes the last two columns.
"""
import csv
import sys

import mpmath
import numpy as np

import errors
import multipliers_peer
import problems
from run import REFERENCES

TOLERANCES = 1e-12, 1e-13


def taylor(problem, digits):
    """Integrates Euler's equations and the quaternion of a free body; returns its pose at the end."""
    mpmath.mp.dps = digits
    body = problem.bodies[0]
    a, b, c = (mpmath.mpf(repr(float(x))) ** 2 for x in problems.LINK_AXES)
    I = b + c, a + c, a + b

    def rate(_, y):
        p, q, r, w, i, j, k = y
        return [(I[1] - I[2]) * q * r / I[0], (I[2] - I[0]) * r * p / I[1], (I[0] - I[1]) * p * q / I[2],
                -(i * p + j * q + k * r) / 2, (w * p + j * r - k * q) / 2, (w * q + k * p - i * r) / 2,
                (w * r + i * q - j * p) / 2]

    start = [mpmath.mpf(repr(float(x))) for x in (*body.omega, *body.quat)]
    end = mpmath.odefun(rate, 0, start)(problem.end)
    return np.zeros((1, 3)), np.array([[float(x) for x in end[3:]]])


def second(problem):
    """Returns the name of the second method, and its poses with the looser and the tighter setting."""
    if problem.name == "A":
        return "taylor", taylor(problem, 20), taylor(problem, 25)
    return "multipliers", *(multipliers_peer.run(problem, t)[1:] for t in TOLERANCES)


def main():
    source = sys.argv[2] if len(sys.argv) > 2 else REFERENCES
    references = errors.read_references(source)
    with open(source, newline="") as file:
        own = {row["problem"]: row["difference"] for row in csv.DictReader(file)}
    with open(sys.argv[1], "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow("problem,second_method,reference_difference,second_difference,agreement".split(","))
        for name in problems.MAKERS:
            problem = problems.problem(name)
            method, loose, tight = second(problem)
            table.writerow([name, method, own[name], f"{errors.error(problem, loose, tight):.3e}",
                            f"{errors.error(problem, tight, references[name]):.3e}"])
            file.flush()


if __name__ == "__main__":
    main()
