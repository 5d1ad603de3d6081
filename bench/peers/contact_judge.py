"""Computes overlaps, energies and errors of a contact run from sampled states, in the same way for every engine.

A sample is an array (bodies, 13): centre, quaternion w x y z, velocity (world), angular velocity (body frame).
"""
import numpy as np

from contact_problems import GRAVITY, sliding_block


def rotations(quaternions):
    """Returns rotation matrices, body to world, of quaternions w x y z in rows."""
    w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1)[:, None]).T
    return np.stack([np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=1),
                     np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=1),
                     np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)], axis=1)


def reach_down(shape, half, down):
    """Returns how far a body reaches from its centre in the unit directions `down` (body frame, rows), m."""
    scaled = np.abs(down) * half
    if shape in ("ellipsoid", "ball"):
        return np.linalg.norm(scaled, axis=1)
    if shape == "box":
        return scaled.sum(axis=1)
    if shape == "cylinder":
        return np.hypot(scaled[:, 0], scaled[:, 1]) + scaled[:, 2]
    return half[0] + scaled[:, 2]


def surface_depth(problem, samples):
    """Returns the largest depth of a body in the plane or in the bowl, m."""
    depth = 0.0
    for i, body in enumerate(problem.bodies):
        centres = samples[:, i, :3]
        if problem.bowl:
            gap = problem.bowl.gap(centres, body.half[0])
        else:
            gap = centres[:, 2] - reach_down(body.shape, body.half, -rotations(samples[:, i, 3:7])[:, 2])
        depth = max(depth, -gap.min())
    return depth


def pair_depth(problem, samples):
    """Returns the largest overlap of two ellipsoids, m, by the GJK and EPA algorithms of coal."""
    import coal
    shapes = [coal.Ellipsoid(*body.half) for body in problem.bodies]
    sizes = np.array([body.half.max() for body in problem.bodies])
    request, depth = coal.DistanceRequest(), 0.0
    for sample in samples:
        places = [coal.Transform3s(R, c) for R, c in zip(rotations(sample[:, 3:7]), sample[:, :3])]
        apart = np.linalg.norm(sample[:, None, :3] - sample[None, :, :3], axis=2)
        for i, j in zip(*np.nonzero(np.triu(apart < sizes[:, None] + sizes, 1))):
            gap = coal.distance(shapes[i], places[i], shapes[j], places[j], request, coal.DistanceResult())
            depth = max(depth, -gap)
    return depth


def energies(problem, samples):
    """Returns the kinetic and the potential energy of each sample, J."""
    masses = np.array([body.mass for body in problem.bodies])
    moments = np.array([body.inertia for body in problem.bodies])
    kinetic = (samples[:, :, 7:10]**2).sum(axis=2) @ masses / 2 + (samples[:, :, 10:13]**2 * moments).sum(axis=(1, 2)) / 2
    return kinetic, GRAVITY * samples[:, :, 2] @ masses


def energy_error(problem, times, samples):
    """Returns the error of the energy, relative to the energy that can be lost.

    The block has a closed form of its energy. In the other problems energy can only decrease: the error is the largest
    increase above an earlier value.
    """
    kinetic, potential = energies(problem, samples)
    total = kinetic + potential
    if problem.name == "block":
        exact = sliding_block(times)[1]
        return float(np.abs(total - potential[0] - exact).max() / exact[0])
    return float((total - np.minimum.accumulate(total)).max() / (total.max() - total.min()))


def judge(problem, times, samples, reference):
    """Returns (median error and largest error of the centres at the end in m, largest depth in m, error of the energy).

    reference: exact centres at the end (bodies, 3), or None if the centres are not compared.
    """
    if not np.isfinite(samples).all():
        raise RuntimeError("a state of the run is not finite")
    errors = (np.full(2, np.nan) if reference is None
              else np.linalg.norm(samples[-1, :, :3] - reference, axis=1))
    depth = surface_depth(problem, samples)
    if problem.meet:
        depth = max(depth, pair_depth(problem, samples))
    return float(np.median(errors)), float(errors.max()), depth, energy_error(problem, times, samples)
