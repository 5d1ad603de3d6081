"""Checks the reference of the problem "slide" without an engine, by the equations of a rod that touches the plane at two points.

A rod is a cylinder or capsule on its side. Relative to its centre, it touches the plane at the points q = s l e - r z, s = 1
and -1: e is its axis, r its radius and l the half length of its straight side. The unknowns are the centre, the heading of e,
the rate of rotation about z and the rate of rotation about e. The normal forces N follow from m g = sum N and from the moment
about the horizontal direction z x e, about which the rod cannot rotate. Friction is -mu N u / sqrt(|u|^2 + eps^2) with the
velocity u of the point; for eps -> 0 this is Coulomb's law.
"""
import numpy as np

from contact_judge import rotations
from contact_problems import FRICTION, GRAVITY

REGULARISATION, STEP = 3e-3, 1e-4  # eps, m/s, and the step of RK4, s
UP = np.array([0, 0, 1.0])


def accelerations(bodies, heading, velocity, turn, roll):
    """Returns the accelerations of the centre (m/s^2), and of the rotations about z and about the axis (rad/s^2).

    Rows of `bodies`: mass, moments of inertia across and along the axis, radius, half length. heading: rad; velocity: m/s;
    turn, roll: rates of rotation about z and about the axis, rad/s.
    """
    mass, across, along, radius, half = bodies.T
    axis = np.stack([np.cos(heading), np.sin(heading), 0 * heading], axis=1)
    omega = turn[:, None] * UP + roll[:, None] * axis
    points = [s * half[:, None] * axis - radius[:, None] * UP for s in (1, -1)]
    forces = []  # contact force for a normal force of 1 N
    for q in points:
        u = velocity + np.cross(omega, q)
        forces.append(UP - FRICTION * u / np.sqrt((u * u).sum(axis=1) + REGULARISATION**2)[:, None])
    moments = [np.cross(q, f) for q, f in zip(points, forces)]
    tilts = [(np.cross(UP, axis) * m).sum(axis=1) for m in moments]
    first = (along * roll * turn - tilts[1] * mass * GRAVITY) / (tilts[0] - tilts[1])
    normal = first, mass * GRAVITY - first
    force = sum(n[:, None] * f for n, f in zip(normal, forces))
    moment = sum(n[:, None] * m for n, m in zip(normal, moments))
    return force / mass[:, None] * [1, 1, 0], moment[:, 2] / across, (moment * axis).sum(axis=1) / along


def places(problem):
    """Returns (numbers of the rods among the bodies, centres of the rods at the end in m)."""
    rods = [i for i, body in enumerate(problem.bodies) if body.shape != "box"]
    chosen = [problem.bodies[i] for i in rods]
    axes = rotations(np.array([body.quaternion for body in chosen]))[:, :, 2]
    bodies = np.array([[b.mass, b.inertia[0], b.inertia[2], b.half[0], b.half[2]] for b in chosen])
    n = len(rods)
    # Columns: centre (3), heading, velocity (3), rotation about z, rotation about the axis.
    state = np.zeros((n, 9))
    state[:, :3], state[:, 4:7] = [b.centre for b in chosen], [b.velocity for b in chosen]
    state[:, 3] = np.arctan2(axes[:, 1], axes[:, 0])

    def rates(y):
        a, turning, rolling = accelerations(bodies, y[:, 3], y[:, 4:7], y[:, 7], y[:, 8])
        return np.column_stack([y[:, 4:7], y[:, 7], a, turning, rolling])

    for _ in range(round(problem.end / STEP)):
        k1 = rates(state)
        k2 = rates(state + STEP / 2 * k1)
        k3 = rates(state + STEP / 2 * k2)
        k4 = rates(state + STEP * k3)
        state = state + STEP / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return rods, state[:, :3]
