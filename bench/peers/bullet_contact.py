"""Bullet: ellipsoids are hulls, no damping, otherwise default settings."""
import math

import numpy as np
import pybullet

from contact_judge import rotations
from contact_problems import FRICTION, GRAVITY
from hulls import ellipsoid_hull

DISTRIBUTION = "pybullet"
COEFFICIENT = math.sqrt(FRICTION)  # of each body and surface; Bullet multiplies the friction coefficients of the two


def shape_of(body):
    if body.shape == "ellipsoid":
        return pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=ellipsoid_hull(body.half).tolist())
    if body.shape == "ball":
        return pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=body.half[0])
    if body.shape == "box":
        return pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=body.half.tolist())
    kind = pybullet.GEOM_CYLINDER if body.shape == "cylinder" else pybullet.GEOM_CAPSULE
    return pybullet.createCollisionShape(kind, radius=body.half[0], height=2 * body.half[2])


def make(problem, step):
    """Returns (advance, sample): advance(n) makes n steps, sample() returns the states of the bodies."""
    if not pybullet.isConnected():
        pybullet.connect(pybullet.DIRECT)
    pybullet.resetSimulation()
    pybullet.setGravity(0, 0, -GRAVITY)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=step)
    if problem.bowl:
        surface = pybullet.createCollisionShape(
            pybullet.GEOM_MESH, vertices=problem.bowl.vertices.tolist(), indices=problem.bowl.triangles.ravel().tolist(),
            flags=pybullet.GEOM_FORCE_CONCAVE_TRIMESH)
    else:
        surface = pybullet.createCollisionShape(pybullet.GEOM_PLANE)
    pybullet.changeDynamics(pybullet.createMultiBody(0, surface), -1, lateralFriction=COEFFICIENT)
    made = []
    for body in problem.bodies:
        w, *xyz = body.quaternion
        made.append(pybullet.createMultiBody(body.mass, shape_of(body), basePosition=body.centre.tolist(),
                                             baseOrientation=[*xyz, w]))
        pybullet.changeDynamics(made[-1], -1, lateralFriction=COEFFICIENT, linearDamping=0, angularDamping=0,
                                localInertiaDiagonal=body.inertia.tolist())
        turn = rotations(body.quaternion[None])[0]
        pybullet.resetBaseVelocity(made[-1], body.velocity.tolist(), (turn @ body.spin).tolist())
        if not problem.touch:
            pybullet.setCollisionFilterGroupMask(made[-1], -1, 4, 2)  # in group 4; collides with group 2 only (immobile)

    def advance(count):
        for _ in range(count):
            pybullet.stepSimulation()

    def sample():
        states = []
        for one in made:
            centre, (x, y, z, w) = pybullet.getBasePositionAndOrientation(one)
            velocity, omega = pybullet.getBaseVelocity(one)
            turn = rotations(np.array([[w, x, y, z]]))[0]
            states.append([*centre, w, x, y, z, *velocity, *(turn.T @ omega)])
        return np.array(states)

    return advance, sample
