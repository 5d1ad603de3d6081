"""Reference poses at the end, their resolution, and the error of a pose."""
import csv

import numpy as np


def read_references(path):
    """Returns {problem: (centres in m, quaternions w x y z)} at the end, one row per body, from a precision_reference.csv."""
    poses = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            poses.setdefault(row["problem"], []).append([float(row[k]) for k in "x y z qw qx qy qz".split()])
    return {name: (np.array(p)[:, :3], np.array(p)[:, 3:]) for name, p in poses.items()}


def read_resolutions(path):
    """Returns {problem: smallest error that can be resolved}: 100 times the difference of the two reference methods."""
    with open(path, newline="") as file:
        return {row["problem"]: 100 * float(row["difference"]) for row in csv.DictReader(file)}


def error(problem, pose, reference):
    """Returns the largest distance of a body centre from its reference / length of a body; NaN if the pose is not finite.

    pose, reference: (centres, quaternions). For A, returns the angle between the two rotations, rad.
    """
    (c, q), (c0, q0) = pose, reference
    if not (np.isfinite(c).all() and np.isfinite(q).all()):
        return float("nan")
    if not problem.joints:
        w = abs(np.sum(q * q0, axis=1))
        v = q0[:, :1] * q[:, 1:] - q[:, :1] * q0[:, 1:] - np.cross(q0[:, 1:], q[:, 1:])
        return float(np.max(2 * np.arctan2(np.linalg.norm(v, axis=1), w)))
    return float(np.max(np.linalg.norm(c - c0, axis=1)) / problem.length)
