"""Convex hulls that replace ellipsoids in engines without ellipsoids."""
import math

import numpy as np

POINTS = 100


def ellipsoid_hull(half):
    """Returns points of an ellipsoid, distributed evenly on a spiral. half: semi-axes, m."""
    z = 1 - (2 * np.arange(POINTS) + 1) / POINTS
    turn = math.pi * (1 + math.sqrt(5)) * (np.arange(POINTS) + 0.5)
    across = np.sqrt(1 - z * z)
    return np.stack([across * np.cos(turn), across * np.sin(turn), z], axis=1) * half
