"""The rigid problems of bench/linkage.h and bench/problems.h, generated from their parameters.

SI units; quaternions are w x y z, body to world. The origin of a body frame is the centre of mass, and its axes are
principal axes.
"""
from dataclasses import dataclass, field

import numpy as np

DENSITY = 1000.0
LINK_AXES = np.array([0.3, 0.2, 0.1])
NET_RADIUS = 0.1
WORLD = -1


@dataclass
class Body:
    mass: float
    inertia: np.ndarray  # principal moments (3)
    pos: np.ndarray
    quat: np.ndarray
    vel: np.ndarray = field(default_factory=lambda: np.zeros(3))  # of the centre, world axes
    omega: np.ndarray = field(default_factory=lambda: np.zeros(3))  # world axes


@dataclass
class Joint:
    """Ball joint: point ra of body a coincides with point rb of body b; both in body frames. The world is body -1."""

    a: int
    ra: np.ndarray
    b: int
    rb: np.ndarray


@dataclass
class Problem:
    name: str
    end: float  # s
    length: float  # length of a body, m
    gravity: np.ndarray
    bodies: list
    joints: list

    def tree(self):
        """Returns the joints of a spanning tree of minimum depth with the world as root, and the loop-closing joints.

        A joint of the tree is (parent, point of the parent, child, point of the child). Joints of a subtree are consecutive. A free
        body has no joint.
        """
        joints_at = {}
        for k, joint in enumerate(self.joints):
            joints_at.setdefault(joint.a, []).append((k, joint.a, joint.ra, joint.b, joint.rb))
            joints_at.setdefault(joint.b, []).append((k, joint.b, joint.rb, joint.a, joint.ra))
        children, reached, used, level = {}, {WORLD}, set(), [WORLD]
        while level:
            next_level = []
            for body in level:
                for k, *joint in joints_at.get(body, []):
                    child = joint[2]
                    if child in reached:
                        continue
                    reached.add(child)
                    used.add(k)
                    children.setdefault(body, []).append(joint)
                    next_level.append(child)
            level = next_level
        spanning, pending = [], children.get(WORLD, [])[:]
        while pending:
            spanning.append(pending.pop())
            pending += reversed(children.get(spanning[-1][2], []))
        return spanning, [joint for k, joint in enumerate(self.joints) if k not in used]


def rotation(q):
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def conjugate(q):
    return q * np.array([1, -1, -1, -1])


def product(p, q):
    return np.concatenate(
        ([p[0] * q[0] - p[1:] @ q[1:]], p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:]))
    )


def turn(axis, angle):
    q = np.zeros(4)
    q[0], q[1 + axis] = np.cos(angle / 2), np.sin(angle / 2)
    return q


def ellipsoid(axes, pos, quat):
    a, b, c = axes
    mass = DENSITY * 4 / 3 * np.pi * a * b * c
    inertia = mass / 5 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
    return Body(mass, inertia, np.asarray(pos, float), quat)


NEAR, FAR = LINK_AXES * [-1, 0, 0], LINK_AXES * [1, 0, 0]
GRAVITY = np.array([0, 0, -9.81])


def free():
    body = ellipsoid(LINK_AXES, [0, 0, 0], turn(0, 0))
    body.omega = np.array([0.01, 5, 0.01])
    return Problem("A", 10, 1, np.zeros(3), [body], [])


def pendulum():
    quat = turn(1, np.pi / 6)
    body = ellipsoid(LINK_AXES, rotation(quat) @ FAR, quat)
    body.omega = np.array([0, 0, 3.0])
    body.vel = np.cross(body.omega, body.pos)
    return Problem("B", 10, 2 * LINK_AXES[0], GRAVITY, [body], [Joint(WORLD, np.zeros(3), 0, NEAR)])


def chain(n):
    bodies = [ellipsoid(LINK_AXES, (2 * i + 1) * FAR, turn(0, 0.7 * i)) for i in range(n)]
    joints = [Joint(i - 1, FAR if i else np.zeros(3), i, NEAR) for i in range(n)]
    return Problem(f"C{n}", 2, 2 * LINK_AXES[0], GRAVITY, bodies, joints)


def net(n, end):
    r = NET_RADIUS
    slope_x = [0.5 * np.sin(1 + 1.7 * i) for i in range(n)]
    slope_y = [0.4 * np.cos(0.5 + 1.3 * j) for j in range(n)]
    along_x = [np.array([np.cos(s), 0, np.sin(s)]) for s in slope_x]
    along_y = [np.array([0, np.cos(s), np.sin(s)]) for s in slope_y]
    bodies, joints = [], []
    for i in range(n):
        for j in range(n):
            pos = 2 * r * (sum(along_x[:i], np.zeros(3)) + sum(along_y[:j], np.zeros(3)))
            bodies.append(ellipsoid([r, r, r], pos, turn(0, 0)))
    tip = np.array([-r, 0, 0])
    for corner in (0, n - 1):
        joints.append(Joint(WORLD, bodies[corner].pos + tip, corner, tip))
    for i in range(n):
        for j in range(n):
            k = i * n + j
            if i + 1 < n:
                joints.append(Joint(k, r * along_x[i], k + n, -r * along_x[i]))
            if j + 1 < n:
                joints.append(Joint(k, r * along_y[j], k + 1, -r * along_y[j]))
    return Problem(f"D{n}", end, 2 * r, GRAVITY, bodies, joints)


MAKERS = {
    "A": free,
    "B": pendulum,
    **{f"C{n}": (lambda n=n: chain(n)) for n in (8, 32, 128, 512)},
    **{f"D{n}": (lambda n=n, end=end: net(n, end)) for n, end in ((4, 1.0), (8, 0.5), (16, 0.25))},
}


def problem(name):
    return MAKERS[name]()
