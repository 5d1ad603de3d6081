"""Drake: ellipsoids on a plane, point contact, solver SAP."""
import logging

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.geometry import Ellipsoid, HalfSpace
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlant, CoulombFriction, MultibodyPlantConfig
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from contact_problems import FRICTION, GRAVITY

DISTRIBUTION = "drake"
logging.getLogger("drake").setLevel(logging.ERROR)  # no warnings that half spaces do not touch soft bodies


def make(problem, step):
    """Returns (advance, sample): advance(n) makes n steps, sample() returns the states of the bodies, which start at rest."""
    friction = CoulombFriction(FRICTION, FRICTION)
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlant(MultibodyPlantConfig(
        time_step=step, contact_model="point", discrete_contact_approximation="sap"), builder)
    plant.mutable_gravity_field().set_gravity_vector([0, 0, -GRAVITY])
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "floor", friction)
    made = []
    for i, body in enumerate(problem.bodies):
        added = plant.AddRigidBody(f"body{i}", SpatialInertia.SolidEllipsoidWithMass(body.mass, *body.half))
        plant.RegisterCollisionGeometry(added, RigidTransform(), Ellipsoid(*body.half), f"body{i}", friction)
        made.append((added, RigidTransform(Quaternion(body.quaternion), body.centre)))
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyContextFromRoot(simulator.get_context())
    for body, pose in made:
        plant.SetFreeBodyPose(plant.GetMyMutableContextFromRoot(simulator.get_mutable_context()), body, pose)
    simulator.Initialize()

    def sample():
        states = []
        for body, _ in made:
            pose, velocity = plant.EvalBodyPoseInWorld(context, body), plant.EvalBodySpatialVelocityInWorld(context, body)
            turn = pose.rotation()
            states.append([*pose.translation(), *turn.ToQuaternion().wxyz(), *velocity.translational(),
                           *(turn.inverse() @ velocity.rotational())])
        return np.array(states)

    return lambda count: simulator.AdvanceTo(simulator.get_context().get_time() + count * step), sample
