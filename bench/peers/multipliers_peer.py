"""Exact multipliers in NumPy: a second method, which confirms the references. It belongs to no engine.

Each body has 6 velocities. Multipliers make the relative accelerations of the joint points zero. A banded Cholesky
factor gives the multipliers. The method DOP853 of order 8 integrates the system.
"""
from functools import partial

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import solveh_banded
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee

from problems import WORLD
from timing import minimum_seconds

DISTRIBUTION = "scipy"


def rotations(q):
    """Returns the rotation matrices of quaternions in rows w x y z, which are normalised first."""
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    R = np.empty((len(q), 3, 3))
    R[:, 0, 0], R[:, 0, 1], R[:, 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[:, 1, 0], R[:, 1, 1], R[:, 1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[:, 2, 0], R[:, 2, 1], R[:, 2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return R


def cross_matrices(r):
    K = np.zeros((len(r), 3, 3))
    K[:, 0, 1], K[:, 0, 2], K[:, 1, 2] = -r[:, 2], r[:, 1], -r[:, 0]
    return K - K.transpose(0, 2, 1)


class Multipliers:
    """The accelerations of a problem. y = (centres, quaternions, velocities in world axes, angular velocities in body axes)."""

    def __init__(self, problem):
        bodies = problem.bodies
        self.n = len(bodies)
        self.inverse_mass = 1 / np.array([b.mass for b in bodies])
        self.inertia = np.array([b.inertia for b in bodies])
        self.gravity = problem.gravity
        self.start = np.concatenate(
            [
                np.array([b.pos for b in bodies]).ravel(),
                np.array([b.quat for b in bodies]).ravel(),
                np.array([b.vel for b in bodies]).ravel(),
                np.array([rotations(b.quat[None])[0].T @ b.omega for b in bodies]).ravel(),
            ]
        )
        self.joints = len(problem.joints)
        if self.joints:
            self._pattern(self._numbered(problem.joints))

    @staticmethod
    def _numbered(joints):
        """Returns the joints in an order in which the matrix of the multipliers has a small bandwidth."""
        share = [(i, j) for i, a in enumerate(joints) for j, b in enumerate(joints)
                 if {a.a, a.b} & {b.a, b.b} - {WORLD}]
        rows, columns = np.array(share).T
        graph = coo_matrix((np.ones(len(share)), (rows, columns))).tocsr()
        return [joints[k] for k in reverse_cuthill_mckee(graph, symmetric_mode=True)]

    def _pattern(self, joints):
        # A side is the point of a joint on a body. Each pair of sides on one body contributes a 3 x 3 block to the matrix.
        sides = [(k, body, point, sign) for k, joint in enumerate(joints)
                 for body, point, sign in ((joint.a, joint.ra, 1.0), (joint.b, joint.rb, -1.0)) if body != WORLD]
        self.side_joint = np.array([s[0] for s in sides])
        self.side_body = np.array([s[1] for s in sides])
        self.side_point = np.array([s[2] for s in sides])
        self.side_sign = np.array([s[3] for s in sides])
        self.side_cross = cross_matrices(self.side_point)
        on_body = [[] for _ in range(self.n)]
        for s, body in enumerate(self.side_body):
            on_body[body].append(s)
        pairs = [(s, t) for group in on_body for s in group for t in group if sides[s][0] >= sides[t][0]]
        self.pair_s, self.pair_t = np.array(pairs).T
        self.pair_body = self.side_body[self.pair_s]
        sign = self.side_sign[self.pair_s] * self.side_sign[self.pair_t]
        self.pair_scale = (sign * self.inverse_mass[self.pair_body])[:, None, None] * np.eye(3)
        # sign [r_s] I^-1 [r_t]^T is constant in the body frame; [r] is the cross-product matrix of r.
        inverse = 1 / self.inertia[self.pair_body]
        self.pair_turn = sign[:, None, None] * (
            self.side_cross[self.pair_s] * inverse[:, None, :] @ self.side_cross[self.pair_t].transpose(0, 2, 1)
        )
        row = 3 * self.side_joint[self.pair_s][:, None, None] + np.arange(3)[:, None]
        column = 3 * self.side_joint[self.pair_t][:, None, None] + np.arange(3)
        low = row >= column
        self.low = np.broadcast_to(low, (len(pairs), 3, 3))
        row, column = (np.broadcast_to(x, self.low.shape)[self.low] for x in (row, column))
        self.band = int((row - column).max()) + 1
        self.flat = (row - column) * 3 * self.joints + column

    def split(self, y):
        n = self.n
        return (y[: 3 * n].reshape(n, 3), y[3 * n : 7 * n].reshape(n, 4), y[7 * n : 10 * n].reshape(n, 3),
                y[10 * n :].reshape(n, 3))

    def rate(self, _, y):
        _, q, v, w = self.split(y)
        spin = np.empty_like(q)
        spin[:, 0] = -0.5 * np.einsum("ij,ij->i", q[:, 1:], w)
        spin[:, 1:] = 0.5 * (q[:, :1] * w + np.cross(q[:, 1:], w))
        a = np.broadcast_to(self.gravity, v.shape).copy()
        alpha = np.cross(self.inertia * w, w) / self.inertia
        if self.joints:
            R = rotations(q)
            bodies = self.side_body
            Rs, ws, r = R[bodies], w[bodies], self.side_point
            local = np.cross(alpha[bodies], r) + np.cross(ws, np.cross(ws, r))
            free = self.side_sign[:, None] * (a[bodies] + np.einsum("sij,sj->si", Rs, local))
            bias = np.zeros((self.joints, 3))
            np.add.at(bias, self.side_joint, free)
            Rp = R[self.pair_body]
            blocks = self.pair_scale + Rp @ self.pair_turn @ Rp.transpose(0, 2, 1)
            matrix = np.bincount(self.flat, blocks[self.low], self.band * 3 * self.joints)
            force = solveh_banded(matrix.reshape(self.band, -1), -bias.ravel(), lower=True, check_finite=False)
            on_side = self.side_sign[:, None] * force.reshape(-1, 3)[self.side_joint]
            np.add.at(a, bodies, on_side * self.inverse_mass[bodies][:, None])
            torque = np.cross(r, np.einsum("sji,sj->si", Rs, on_side))
            np.add.at(alpha, bodies, torque / self.inertia[bodies])
        return np.concatenate([v.ravel(), spin.ravel(), a.ravel(), alpha.ravel()])


def run(problem, tolerance):
    """Returns CPU seconds, and the centres and quaternions at the end."""
    system = Multipliers(problem)
    paths = []
    seconds, _ = minimum_seconds(lambda: None, lambda _: paths.append(
        solve_ivp(system.rate, (0, problem.end), system.start, "DOP853", t_eval=[problem.end], rtol=tolerance,
                  atol=tolerance)))
    if not paths[-1].success:
        raise RuntimeError(paths[-1].message)
    c, q, _, _ = system.split(paths[-1].y[:, -1])
    return seconds, c, q / np.linalg.norm(q, axis=1, keepdims=True)


def ladders(problem, folder):
    yield "free+multipliers", "dop853", [10.0**-k for k in range(2, 13)], partial(run, problem)
