"""Rapier: single precision, ellipsoids are hulls, Coulomb friction; the length unit is the size of a body."""
import math

import numpy as np
import rapier3d

from contact_judge import rotations
from contact_problems import FRICTION, GRAVITY
from hulls import ellipsoid_hull

DISTRIBUTION = "rapier3d"
SIZE = 0.1  # typical size of a body, m; Rapier derives the permitted overlaps from this length


def collider_of(body):
    if body.shape == "ellipsoid":
        return rapier3d.Collider.convex_hull(ellipsoid_hull(body.half).astype(np.float32))
    if body.shape == "ball":
        return rapier3d.Collider.ball(body.half[0])
    if body.shape == "box":
        return rapier3d.Collider.cuboid(*body.half)
    if body.shape == "cylinder":  # its axis is y in Rapier
        return rapier3d.Collider.cylinder(body.half[2], body.half[0]).rotation((math.pi / 2, 0, 0))
    return rapier3d.Collider.capsule_z(body.half[2], body.half[0])


def surface_of(bowl):
    if bowl:
        return rapier3d.Collider.trimesh(bowl.vertices.astype(np.float32), bowl.triangles.astype(np.uint32))
    return rapier3d.Collider.halfspace((0, 0, 1))


def with_contact(collider, problem, is_surface):
    made = collider.friction(FRICTION).restitution(0).density(0)
    if not problem.touch:
        mine, others = (rapier3d.Group.GROUP_1, rapier3d.Group.GROUP_2)[::1 if is_surface else -1]
        made = made.collision_groups(rapier3d.InteractionGroups(mine, others))
    return made


def make(problem, step):
    """Returns (advance, sample): advance(n) makes n steps, sample() returns the states of the bodies."""
    world = rapier3d.PhysicsWorld(gravity=(0, 0, -GRAVITY))
    world.set_num_threads(1)
    world.integration_parameters.dt = step
    world.integration_parameters.length_unit = SIZE
    world.integration_parameters.friction_model = rapier3d.FrictionModel.COULOMB
    world.add_collider(with_contact(surface_of(problem.bowl), problem, True))
    made = []
    for body in problem.bodies:
        turn = rotations(body.quaternion[None])[0]
        builder = (rapier3d.RigidBody.dynamic().position(rapier3d.Isometry3(body.centre, rapier3d.Rotation3(*body.quaternion)))
                   .linvel(body.velocity).angvel(turn @ body.spin).can_sleep(False).gyroscopic_forces(True)
                   .additional_mass_properties(rapier3d.MassProperties((0, 0, 0), body.mass, body.inertia)))
        handle = world.add_body(builder)
        world.add_collider(with_contact(collider_of(body), problem, False), parent=handle)
        made.append(handle)

    def advance(count):
        for _ in range(count):
            world.step()

    def sample():
        states = []
        for handle in made:
            one = world.rigid_bodies[handle]
            c, q, v, omega = one.translation, one.rotation, one.linvel, one.angvel
            quaternion = [q.w, q.i, q.j, q.k]
            turn = rotations(np.array([quaternion]))[0]
            states.append([*c, *quaternion, *v, *(turn.T @ np.array([*omega]))])
        return np.array(states)

    return advance, sample
