"""Exudyn: explicit runs with Lie-group nodes and kinematic trees, and implicit runs with spherical joints."""
from functools import partial

import exudyn as exu
import exudyn.utilities as items
import numpy as np
from scipy.spatial.transform import Rotation

import angles
from problems import WORLD, rotation
from timing import minimum_seconds

DISTRIBUTION = "exudyn"

exu.SetWriteToConsole(False)
SPARSE_FROM = 4  # smallest number of bodies for which the linear solver is sparse
REVOLUTE = {"X": exu.JointType.RevoluteX, "Y": exu.JointType.RevoluteY, "Z": exu.JointType.RevoluteZ}


class Bodies:
    """One node of 6 or 7 coordinates per body, and spherical joints between bodies."""

    def __init__(self, problem, node):
        self.system = exu.SystemContainer().AddSystem()
        mbs = self.system
        ground = mbs.AddObject(items.ObjectGround())
        self.bodies = []
        for body in problem.bodies:
            inertia = items.RigidBodyInertia(mass=body.mass, inertiaTensor=np.diag(body.inertia))
            number = mbs.CreateRigidBody(inertia=inertia, nodeType=node, referencePosition=body.pos,
                                       referenceRotationMatrix=rotation(body.quat), initialVelocity=body.vel,
                                       initialAngularVelocity=body.omega, gravity=problem.gravity)
            self.bodies.append(number)
        for joint in problem.joints:
            markers = [mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=ground if k == WORLD else self.bodies[k],
                                                           localPosition=point))
                       for k, point in ((joint.a, joint.ra), (joint.b, joint.rb))]
            mbs.AddObject(items.SphericalJoint(markerNumbers=markers))
        mbs.Assemble()

    def pose(self):
        def output(kind):
            return np.array([self.system.GetObjectOutputBody(b, kind) for b in self.bodies])

        R = output(exu.OutputVariableType.RotationMatrix).reshape(-1, 3, 3)
        return output(exu.OutputVariableType.Position), np.roll(Rotation.from_matrix(R).as_quat(), 1, axis=1)


class Tree:
    """Minimal coordinates: three revolute joints per ball joint; the two links between these joints have no mass."""

    def __init__(self, problem):
        self.problem = problem
        self.spanning, _ = problem.tree()
        kinds, parents, offsets, inertias, centres, masses = [], [], [], [], [], []
        start, rates, last, origin = [], [], {WORLD: -1}, {WORLD: np.zeros(3)}
        for parent, rp, child, rc in self.spanning:
            body = problem.bodies[child]
            for k, axis in enumerate(angles.order(problem)):
                kinds.append(REVOLUTE[axis])
                parents.append(last[parent] if k == 0 else len(kinds) - 2)
                offsets.append(rp - origin[parent] if k == 0 else np.zeros(3))
                inertias.append(np.diag(body.inertia) if k == 2 else np.zeros((3, 3)))
                centres.append(-rc if k == 2 else np.zeros(3))
                masses.append(body.mass if k == 2 else 0)
            last[child], origin[child] = len(kinds) - 1, rc
            joint_angles, joint_rates = angles.start(problem, parent, child)
            start += list(joint_angles)
            rates += list(joint_rates)
        self.system = exu.SystemContainer().AddSystem()
        n = len(kinds)
        node = self.system.AddNode(items.NodeGenericODE2(
            numberOfODE2Coordinates=n, referenceCoordinates=[0] * n, initialCoordinates=start,
            initialCoordinates_t=rates))
        self.system.AddObject(items.ObjectKinematicTree(
            nodeNumber=node, gravity=problem.gravity, jointTypes=kinds, linkParents=parents,
            jointTransformations=exu.Matrix3DList([np.eye(3)] * n), jointOffsets=exu.Vector3DList(offsets),
            linkInertiasCOM=exu.Matrix3DList(inertias), linkCOMs=exu.Vector3DList(centres), linkMasses=masses))
        self.system.Assemble()

    def pose(self):
        q = self.system.systemData.GetODE2Coordinates().reshape(-1, 3)
        placed = {WORLD: (np.zeros(3), np.eye(3))}
        for (parent, rp, child, rc), joint_angles in zip(self.spanning, q):
            c, R = placed[parent]
            child_rotation = R @ angles.matrix(self.problem, joint_angles)
            placed[child] = c + R @ rp - child_rotation @ rc, child_rotation
        poses = [placed[i] for i in range(len(q))]
        R = np.array([R for _, R in poses])
        return np.array([c for c, _ in poses]), np.roll(Rotation.from_matrix(R).as_quat(), 1, axis=1)


def settings(problem, kind):
    s = exu.SimulationSettings()
    s.solutionSettings.writeSolutionToFile = False
    s.timeIntegration.verboseMode = 0
    s.timeIntegration.endTime = problem.end
    s.timeIntegration.solverType = kind
    s.timeIntegration.automaticStepSize = s.timeIntegration.adaptiveStep = False
    if kind == exu.DynamicSolverType.TrapezoidalIndex2:
        s.timeIntegration.generalizedAlpha.useNewmark = True
        s.timeIntegration.generalizedAlpha.useIndex2Constraints = True
    sparse = len(problem.bodies) >= SPARSE_FROM
    s.linearSolver.solverType = exu.LinearSolverType.EigenSparse if sparse else exu.LinearSolverType.EXUdense
    return s


def solve(model, make_solver, options):
    mbs = model.system

    def prepare():
        solver = make_solver()
        if not solver.InitializeSolver(mbs, options):
            raise RuntimeError("cannot start: " + solver.GetErrorString())
        return solver

    failed = []

    def loop(solver):
        failed.append(not solver.SolveSteps(mbs, options))

    seconds, solver = minimum_seconds(prepare, loop)
    solver.FinalizeSolver(mbs, options)
    if any(failed):
        raise RuntimeError(solver.GetErrorString())
    return seconds, *model.pose()


def by_steps(problem, make_model, make_solver, kind, step):
    options = settings(problem, kind)
    options.timeIntegration.numberOfSteps = round(problem.end / step)
    return solve(make_model(problem), make_solver, options)


def by_tolerance(problem, make_model, kind, tolerance):
    options = settings(problem, kind)
    time = options.timeIntegration
    time.automaticStepSize = True
    time.numberOfSteps = round(problem.end / 0.1)  # sets the longest step to 0.1 s
    time.initialStepSize, time.minimumStepSize = 1e-4, 1e-9
    time.relativeTolerance = time.absoluteTolerance = tolerance
    return solve(make_model(problem), exu.MainSolverExplicit, options)


def ladders(problem, folder):
    kinds = exu.DynamicSolverType
    steps = [0.02 / 2**k for k in range(20)]
    tolerances = [10.0**-k for k in range(2, 14)]
    lie = partial(Bodies, node=exu.NodeType.RotationRotationVector)
    open_tree = problem.joints and not problem.tree()[1]
    if open_tree or not problem.joints:
        formulation, model = ("tree", Tree) if open_tree else ("lie_group", lie)
        for name, kind in (("rk44", kinds.RK44), ("rk67", kinds.RK67)):
            yield formulation, name, steps, partial(by_steps, problem, model, exu.MainSolverExplicit, kind)
        yield formulation, "dopri5", tolerances, partial(by_tolerance, problem, model, kinds.DOPRI5)
    parameters = partial(Bodies, node=exu.NodeType.RotationEulerParameters)
    implicit = exu.MainSolverImplicitSecondOrder
    yield "joints", "generalized_alpha", steps, partial(by_steps, problem, lie, implicit, kinds.GeneralizedAlpha)
    yield "joints", "trapezoidal", steps, partial(by_steps, problem, parameters, implicit, kinds.TrapezoidalIndex2)
