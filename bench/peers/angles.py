"""Ball joints as three angles, for engines that have no other: in the order that keeps the middle one small."""
import numpy as np
from scipy.spatial.transform import Rotation

from problems import conjugate, product, rotation


def order(problem):
    """Axes in turn, each of the frame that those before it turned: a chain swings about y, B goes round z."""
    return "ZYX" if problem.name == "B" else "YZX"


def matrix(problem, angles):
    return Rotation.from_euler(order(problem), angles).as_matrix()


def start(problem, parent, child):
    """Angles of body child in body parent and their rates."""
    body = problem.bodies[child]
    quat, omega, world = body.quat, body.omega, np.eye(3)
    if parent >= 0:
        over = problem.bodies[parent]
        quat, omega, world = product(conjugate(over.quat), quat), omega - over.omega, rotation(over.quat)
    axes = ["XYZ".index(axis) for axis in order(problem)]
    angles = Rotation.from_quat(np.roll(quat, -1)).as_euler(order(problem))
    turned, columns = np.eye(3), []
    for axis, angle in zip(axes, angles):
        columns.append(turned[:, axis])
        turned = turned @ Rotation.from_rotvec(angle * np.eye(3)[axis]).as_matrix()
    return angles, np.linalg.solve(np.column_stack(columns), world.T @ omega)
