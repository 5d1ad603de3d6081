"""Ball joints as three angles, for engines without other ball joints.

The order of the axes keeps the middle angle small, far from the singularity at a right angle.
"""
import numpy as np
from scipy.spatial.transform import Rotation

from problems import conjugate, product, rotation


def order(problem):
    """Returns the axes of the three rotations in order. Each axis belongs to the frame that the earlier rotations have turned.

    The links of a chain swing about y; the body of problem B revolves about z.
    """
    return "ZYX" if problem.name == "B" else "YZX"


def matrix(problem, angles):
    """Returns the rotation matrix, child to parent, of three angles, rad."""
    return Rotation.from_euler(order(problem), angles).as_matrix()


def start(problem, parent, child):
    """Returns the three angles at the start of body child relative to body parent (rad), and their rates (rad/s)."""
    body = problem.bodies[child]
    quat, omega, world = body.quat, body.omega, np.eye(3)
    if parent >= 0:
        parent_body = problem.bodies[parent]
        quat = product(conjugate(parent_body.quat), quat)
        omega, world = omega - parent_body.omega, rotation(parent_body.quat)
    axes = ["XYZ".index(axis) for axis in order(problem)]
    angles = Rotation.from_quat(np.roll(quat, -1)).as_euler(order(problem))
    rotated, columns = np.eye(3), []
    for axis, angle in zip(axes, angles):
        columns.append(rotated[:, axis])
        rotated = rotated @ Rotation.from_rotvec(angle * np.eye(3)[axis]).as_matrix()
    return angles, np.linalg.solve(np.column_stack(columns), world.T @ omega)
