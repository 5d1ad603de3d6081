"""Drake: a tree of ball joints with three angles, continuous plant, error-controlled integrators.

Nets: the discrete solver with ball constraints.
"""
from functools import partial

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant
from pydrake.multibody.tree import BallRpyJoint, FixedOffsetFrame, SpatialInertia, UnitInertia
from pydrake.systems.analysis import GetIntegrationSchemes, ResetIntegratorFromFlags, Simulator

import angles
from problems import WORLD, rotation
from timing import minimum_seconds

DISTRIBUTION = "drake"


def plant_of(problem, step):
    plant = MultibodyPlant(time_step=step)
    if step > 0:
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
    plant.mutable_gravity_field().set_gravity_vector(problem.gravity)
    bodies = {WORLD: plant.world_body()}
    for i, body in enumerate(problem.bodies):
        inertia = SpatialInertia(body.mass, np.zeros(3), UnitInertia(*(body.inertia / body.mass)))
        bodies[i] = plant.AddRigidBody(f"body{i}", inertia)
    # The frames of a joint are rotated so that its yaw, pitch and roll are the first, second and third angle of
    # angles.py. In the order YZX the pitch is minus the second angle.
    aligned = RotationMatrix() if angles.order(problem) == "ZYX" else RotationMatrix.MakeXRotation(-np.pi / 2)
    spanning, loops = problem.tree()

    def frame(name, body, point):
        return plant.AddFrame(FixedOffsetFrame(name, bodies[body].body_frame(), RigidTransform(aligned, point)))

    joints = [plant.AddJoint(BallRpyJoint(f"joint{child}", frame(f"parent{child}", parent, rp),
                                          frame(f"child{child}", child, rc), 0.0))
              for parent, rp, child, rc in spanning]
    for joint in loops:
        plant.AddBallConstraint(bodies[joint.a], joint.ra, bodies[joint.b], joint.rb)
    plant.Finalize()
    return plant, bodies, joints, aligned


def simulate(problem, step, configure):
    plant, bodies, joints, aligned = plant_of(problem, step)

    def prepare():
        simulator = Simulator(plant)
        context = simulator.get_mutable_context()
        for joint, (parent, _, child, _) in zip(joints, problem.tree()[0]):
            body = problem.bodies[child]
            parent_rotation = rotation(problem.bodies[parent].quat) if parent != WORLD else np.eye(3)
            omega = body.omega - (problem.bodies[parent].omega if parent != WORLD else 0)
            (first, second, third), _ = angles.start(problem, parent, child)
            pitch = second if angles.order(problem) == "ZYX" else -second
            joint.set_angles(context, [third, pitch, first])
            joint.set_angular_velocity(context, aligned.matrix().T @ parent_rotation.T @ omega)
        if not joints:
            for i, body in enumerate(problem.bodies):
                pose = RigidTransform(RotationMatrix(rotation(body.quat)), body.pos)
                plant.SetFreeBodyPose(context, bodies[i], pose)
                plant.SetFreeBodySpatialVelocity(context, bodies[i], SpatialVelocity(body.omega, body.vel))
        configure(simulator)
        simulator.Initialize()
        return simulator

    seconds, simulator = minimum_seconds(prepare, lambda simulator: simulator.AdvanceTo(problem.end))
    context = simulator.get_context()
    poses = [plant.EvalBodyPoseInWorld(context, bodies[i]) for i in range(len(problem.bodies))]
    return (seconds, np.array([X.translation() for X in poses]),
            np.array([X.rotation().ToQuaternion().wxyz() for X in poses]))


def by_tolerance(problem, scheme, tolerance):
    def configure(simulator):
        ResetIntegratorFromFlags(simulator, scheme, 0.1)
        simulator.get_mutable_integrator().set_target_accuracy(tolerance)

    return simulate(problem, 0.0, configure)


def by_steps(problem, step):
    return simulate(problem, problem.end / round(problem.end / step), lambda simulator: None)


def ladders(problem, folder):
    if problem.tree()[1]:
        yield "tree+ball", "discrete_sap", [0.02 / 2**k for k in range(16)], partial(by_steps, problem)
        return
    for scheme in ("runge_kutta3", "runge_kutta5"):
        if scheme in GetIntegrationSchemes():
            yield "tree", scheme, [10.0**-k for k in range(1, 14)], partial(by_tolerance, problem, scheme)
