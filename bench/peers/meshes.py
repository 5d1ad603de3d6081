"""Closed triangle meshes: a sphere, and the depth of points inside a mesh."""
import math

import numpy as np


def sphere(triangles):
    """Returns vertices on the unit sphere, the topmost one first, and triangles.

    Each triangle of an icosahedron is divided into four, repeatedly, until there are at least `triangles` of them.
    """
    ring = [[2 * math.cos(a), 2 * math.sin(a), 1] for a in np.arange(10) * math.pi / 5]
    upper, lower = ring[::2], [[x, y, -z] for x, y, z in ring[1::2]]
    points = [np.array(p) / np.linalg.norm(p) for p in [[0, 0, 1], *upper, *lower, [0, 0, -1]]]
    faces = []
    for i in range(5):
        j = (i + 1) % 5
        faces += [(0, 1 + i, 1 + j), (1 + i, 6 + i, 1 + j), (6 + i, 6 + j, 1 + j), (11, 6 + j, 6 + i)]
    while len(faces) < triangles:
        middles, finer = {}, []

        def middle(i, j):
            if (found := middles.get((j, i))) is None:  # each edge occurs once in each direction
                points.append((points[i] + points[j]) / np.linalg.norm(points[i] + points[j]))
                found = middles[i, j] = len(points) - 1
            return found

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return np.array(points), np.array(faces)


def dot(a, b):
    return (a * b).sum(axis=-1)


def deepest_inside(points, corners):
    """Returns the largest distance between the surface of a closed mesh and a point inside the mesh; 0 without such points.

    points: (n, 3); corners: (triangles, 3, 3), the corners of each triangle, counter-clockwise seen from outside.
    """
    points = points[((points > corners.min(axis=(0, 1))) & (points < corners.max(axis=(0, 1)))).all(axis=1)]
    sides = [corners[:, k] - points[:, None] for k in range(3)]
    a, b, c = sides
    la, lb, lc = (np.linalg.norm(side, axis=2) for side in sides)
    denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    inside = np.arctan2(dot(a, np.cross(b, c)), denominator).sum(axis=1) > math.pi  # sum of half solid angles
    if not inside.any():
        return 0.0
    a, b, c = (side[inside] for side in sides)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=2)[..., None]
    to_edges, above = np.inf, True
    for p, q in ((a, b), (b, c), (c, a)):
        above &= dot(np.cross(p, q), normal) >= 0
        share = np.clip(-dot(p, q - p) / dot(q - p, q - p), 0, 1)
        to_edges = np.minimum(to_edges, np.linalg.norm(p + share[..., None] * (q - p), axis=2))
    return np.where(above, np.abs(dot(a, normal)), to_edges).min(axis=1).max()
