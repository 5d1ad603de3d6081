"""MuJoCo: elliptic friction cone, Newton solver, the stiffest contacts that the documentation calls stable."""
import mujoco
import numpy as np

from contact_problems import FRICTION, GRAVITY

DISTRIBUTION = "mujoco"
BASE = 0.1  # thickness of the height field below its lowest point, m
GEOMS = {"ellipsoid": "ELLIPSOID", "ball": "SPHERE", "box": "BOX", "cylinder": "CYLINDER", "capsule": "CAPSULE"}


def contact(step):
    """Returns contact parameters. The time constant of the contact springs is twice the step."""
    return {"solref": [2 * step, 1], "friction": [FRICTION, 0.005, 0.0001]}


def add_surface(spec, problem, step):
    bowl = problem.bowl
    if not bowl:
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1, 1, 1], **contact(step))
        return
    n = bowl.cells + 1
    spec.add_hfield(name="bowl", nrow=n, ncol=n, userdata=bowl.heights.ravel(),
                    size=[bowl.half_width, bowl.half_width, bowl.heights.max(), BASE])
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_HFIELD, hfieldname="bowl", **contact(step))


def make(problem, step):
    """Returns (advance, sample): advance(n) makes n steps, sample() returns the states of the bodies."""
    spec = mujoco.MjSpec()
    spec.option.timestep, spec.option.gravity = step, [0, 0, -GRAVITY]
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    add_surface(spec, problem, step)
    bits = {"contype": 1, "conaffinity": 1} if problem.touch else {"contype": 2, "conaffinity": 1}
    for body in problem.bodies:
        made = spec.worldbody.add_body(pos=body.centre, quat=body.quaternion, mass=body.mass, ipos=[0, 0, 0],
                                       inertia=body.inertia, explicitinertial=True)
        made.add_freejoint()
        made.add_geom(type=getattr(mujoco.mjtGeom, "mjGEOM_" + GEOMS[body.shape]), **bits, **contact(step),
                      size=[body.half[0], body.half[2], 0] if body.shape in ("cylinder", "capsule") else body.half)
    model = spec.compile()
    data = mujoco.MjData(model)
    for i, body in enumerate(problem.bodies):
        data.qvel[6 * i:6 * i + 6] = [*body.velocity, *body.spin]  # the angular velocity is in the body frame
    mujoco.mj_forward(model, data)

    def sample():
        return np.concatenate([data.qpos.reshape(-1, 7), data.qvel.reshape(-1, 6)], axis=1)

    return lambda count: mujoco.mj_step(model, data, nstep=count), sample
