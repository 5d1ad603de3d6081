"""MuJoCo: ball joints in a tree with `connect` for loops, or free bodies with `connect` for all joints."""
from functools import partial

import mujoco

from problems import WORLD, conjugate, product, rotation
from timing import minimum_seconds

DISTRIBUTION = "mujoco"

mujoco.set_mju_user_warning(lambda _: None)  # no messages about runs that fail

IMPEDANCE = [0.9999, 0.9999, 0.001, 0.5, 2]  # of `connect`: the stiffest values that MuJoCo accepts
STEPS_OF_CONNECT = 2  # time constant of `connect` in steps: the shortest that the documentation calls stable


def add_body(parent, body, name, pos, quat):
    return parent.add_body(name=name, pos=pos, quat=quat, mass=body.mass, ipos=[0, 0, 0], inertia=body.inertia,
                           explicitinertial=True)


def connect(spec, step, a, ra, b):
    """Connects body a at its point ra with body b, at their relative pose at the start."""
    name = "world" if a == WORLD else f"body{a}"
    spec.add_equality(type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_BODY, name1=name,
                      name2=f"body{b}", data=[*ra, *[0] * (mujoco.mjNEQDATA - 3)],
                      solref=[STEPS_OF_CONNECT * step, 1], solimp=IMPEDANCE)


def model_of(problem, tree, integrator, step):
    spec = mujoco.MjSpec()
    spec.compiler.autolimits = False
    option = spec.option
    option.timestep, option.integrator, option.gravity = step, integrator, problem.gravity
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_AUTORESET
    option.solver, option.iterations, option.tolerance = mujoco.mjtSolver.mjSOL_NEWTON, 100, 1e-14
    option.ls_iterations, option.ls_tolerance = 100, 1e-6
    spanning, loops = problem.tree()
    bodies = {WORLD: spec.worldbody}
    if tree and spanning:
        for parent, rp, child, rc in spanning:
            body = problem.bodies[child]
            pos, quat = body.pos, body.quat
            if parent != WORLD:
                parent_body = problem.bodies[parent]
                pos = rotation(parent_body.quat).T @ (pos - parent_body.pos)
                quat = product(conjugate(parent_body.quat), quat)
            bodies[child] = add_body(bodies[parent], body, f"body{child}", pos, quat)
            bodies[child].add_joint(type=mujoco.mjtJoint.mjJNT_BALL, pos=rc)
    else:
        for i, body in enumerate(problem.bodies):
            bodies[i] = add_body(spec.worldbody, body, f"body{i}", body.pos, body.quat)
            bodies[i].add_freejoint()
        loops = problem.joints
    for joint in loops:
        connect(spec, step, joint.a, joint.ra, joint.b)
    model = spec.compile()
    data = mujoco.MjData(model)
    for i, body in enumerate(problem.bodies):
        view = model.body(f"body{i}")
        v = data.qvel[view.dofadr[0] :][: view.dofnum[0]]
        if len(v) == 6:
            v[:3] = body.vel
        omega = body.omega
        parent = view.parentid[0]
        if parent and len(v) == 3:
            omega = omega - problem.bodies[int(model.body(parent).name[4:])].omega
        v[-3:] = rotation(body.quat).T @ omega
    return model, data


def run(problem, tree, integrator, step):
    steps = round(problem.end / step)
    model, start = model_of(problem, tree, integrator, problem.end / steps)
    seconds, data = minimum_seconds(lambda: mujoco.MjData.__copy__(start),
                                  lambda data: mujoco.mj_step(model, data, nstep=steps))
    if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
        raise RuntimeError("unstable")
    mujoco.mj_kinematics(model, data)
    ids = [model.body(f"body{i}").id for i in range(len(problem.bodies))]
    return seconds, data.xpos[ids].copy(), data.xquat[ids].copy()


def ladders(problem, folder):
    kinds = mujoco.mjtIntegrator
    steps = [0.02 / 2**k for k in range(20)]
    tree = "tree+connect" if problem.tree()[1] else "tree"
    for name, kind in (("rk4", kinds.mjINT_RK4), ("implicitfast", kinds.mjINT_IMPLICITFAST),
                       ("euler", kinds.mjINT_EULER)):
        yield tree, name, steps, partial(run, problem, True, kind)
    if problem.joints:
        yield "free+connect", "rk4", steps, partial(run, problem, False, kinds.mjINT_RK4)
