#!/usr/bin/env python3
"""Measures contact in other engines with one thread: problems of bench/contact_bench.cpp and balloon_bench.cpp.

usage: contact.py FOLDER [--out contact_peers.csv] [--engines mujoco,bullet] [--problems rigid,balloons] [--most 1000]
                  [--rounds 3]
"""
import argparse
import csv
import importlib
import importlib.metadata
import math
import multiprocessing
import os
import time
import warnings
from pathlib import Path
from types import SimpleNamespace

import numpy as np

import contact_problems
from contact_judge import pair_depth, surface_depth
from contact_precision import version
from contact_problems import DENSITY, Problem, ellipsoids
from meshes import deepest_inside, sphere
from run import in_child

COLUMNS = ("engine,problem,count_or_triangles,step_s,us_per_body_and_step,real_time_factor,deepest_m,"
           "string_error_m").split(",")
GRAVITY = [0, 0, -contact_problems.GRAVITY]
# The problems of contact_bench, with their numbers of layers.
HEAPS = {"ellipsoid, plane": 1, "ellipsoid, heap": 5}
STEP, DURATION, SAMPLED = 2e-3, 1, 10  # s, s, steps between samples of the contacts
# The problems of balloon_bench. beta: stiffness-proportional damping, s; drag: damping of all motion, 1/s.
POISSON, RADIUS, MAX_STEP, MIN_STEP = 0.45, 0.1, 2**-10, 2**-20  # 1, m, s, s
FIRM = SimpleNamespace(E=1e7, thickness=1e-3, pressure=0, beta=0, drag=0)
THIN = SimpleNamespace(E=1e5, thickness=5e-4, pressure=30, beta=3e-4, drag=0.25)
# balloon, count, duration in s, numbers of triangles
BALLOONS = {"drop": (FIRM, 1, 0.5, [320, 1280, 5120]), "nine on strings": (THIN, 9, 1, [320]),
            "nine firm ones on strings": (FIRM, 9, 1, [320])}
MAX_SECONDS = 60  # a configuration is not repeated if its runs so far took more CPU time than this, s


def mujoco_depth(data):
    return max(0, -data.contact.dist.min()) if data.ncon else 0


def rigid_run(engine, count, layers):
    """Returns (CPU s, largest depth in m). Raises RuntimeError if the ellipsoids are not on the plane at the end."""
    problem = Problem("rigid", list(ellipsoids(count, layers)), DURATION)
    advance, sample = importlib.import_module(f"{engine}_contact").make(problem, STEP)
    seconds, samples = 0, []
    for _ in range(round(DURATION / STEP / SAMPLED)):
        start = time.process_time()
        advance(SAMPLED)
        seconds += time.process_time() - start
        samples.append(sample())
    heights = samples[-1][:, 2]
    if not (heights.min() > 0.05 and heights.max() < 0.06 + 0.2 * layers):
        raise RuntimeError("at the end the ellipsoids are not on the plane")
    return seconds, max(surface_depth(problem, np.array(samples)), pair_depth(problem, samples))


def balloons(balloon, count, triangles, step, integrator):
    """Returns a MuJoCo model and the triangles of the balloons, as rows of three vertex numbers.

    The model has one falling balloon, or nine on tendons from hooks to the topmost vertices of the balloons. A balloon
    is a flex with membrane stiffness only.
    """
    import mujoco
    from mujoco_contact import contact
    points, faces = sphere(triangles)
    text = lambda numbers: " ".join(map(str, np.ravel(numbers)))
    mass = DENSITY * balloon.thickness * 4 * math.pi * RADIUS**2
    hooks, parts = [], []
    for i in range(count):
        hook = np.array([0.22 * (i % 3 - 1), 0.22 * (i // 3 - 1), 0]) if count > 1 else np.zeros(3)
        distance, turn = np.linalg.norm(hook), np.zeros(4)
        out, angle = (hook / distance, 0.5) if distance else (hook, 0)
        up = [0, 0, math.cos(angle)] - math.sin(angle) * out
        matrix = np.zeros(9)
        mujoco.mju_quatZ2Vec(turn, up)
        mujoco.mju_quat2Mat(matrix, turn)
        centre = hook - (1 + RADIUS) * up if count > 1 else [0, 0, 1.5 * RADIUS]
        hooks.append(hook)
        parts.append(
            f'<flexcomp name="balloon{i}" type="direct" dim="2" radius="{balloon.thickness / 2}" mass="{mass}"'
            f' point="{text(centre + RADIUS * points @ matrix.reshape(3, 3).T)}" element="{text(faces)}">'
            f'<elasticity young="{balloon.E}" poisson="{POISSON}" thickness="{balloon.thickness}"'
            f' damping="{balloon.beta}" elastic2d="stretch"/><contact selfcollide="none"/></flexcomp>')
    spec = mujoco.MjSpec.from_string(f"<mujoco><worldbody>{''.join(parts)}</worldbody></mujoco>")
    option = spec.option
    option.timestep, option.gravity = step, GRAVITY
    if integrator != "euler":  # with the discrete integrator, the solver CG (conjugate gradients) is the fastest
        option.integrator, option.solver = mujoco.mjtIntegrator.mjINT_DISCRETE, mujoco.mjtSolver.mjSOL_CG
    if integrator == "ipc":
        option.enableflags |= mujoco.mjtEnableBit.mjENBL_IPC
    for flex in spec.flexes:
        flex.solref, flex.friction = contact(step).values()
    if count == 1:
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1, 1, 1], **contact(step))
    else:
        for i, hook in enumerate(hooks):
            spec.worldbody.add_site(name=f"hook{i}", pos=hook)
            spec.body(f"balloon{i}_0").add_site(name=f"top{i}")
            string = spec.add_tendon(limited=True, range=[0, 1], solref_limit=[2 * step, 1],
                                     solimp_limit=[0.9999, 0.9999, 0.001, 0.5, 2])
            string.wrap_site(f"hook{i}")
            string.wrap_site(f"top{i}")
    model = spec.compile()
    model.dof_damping[:] = balloon.drag * model.body_mass[model.dof_bodyid]
    return model, np.concatenate([faces + i * len(points) for i in range(count)])


def deepest_balloon(data, faces, count):
    """Returns the largest depth of contacts and of vertices behind the floor or inside another balloon, m.

    MuJoCo has no contacts for vertices that have passed through a surface.
    """
    each, corners = data.flexvert_xpos.reshape(count, -1, 3), data.flexvert_xpos[faces].reshape(count, -1, 3, 3)
    if count == 1:
        return max(mujoco_depth(data), -each[0, :, 2].min())
    return max(mujoco_depth(data), *(deepest_inside(each[i], corners[j])
                                     for i in range(count) for j in range(count) if i != j))


def add_pressure(model, data, faces, pressure):
    """Applies the forces of an internal pressure (Pa) to the vertices, because flexes have no pressure of their own."""
    a, b, c = data.flexvert_xpos[faces.T]
    forces = np.zeros((model.nflexvert, 3))
    for corner in faces.T:
        np.add.at(forces, corner, pressure / 6 * np.cross(b - a, c - a))
    data.qfrc_applied[:] = forces.ravel()  # the coordinates of the model are x, y, z of the vertices


def balloon_run(balloon, count, duration, triangles, step, integrator):
    """Returns (CPU s, largest depth in m, largest stretch of a string in m), or None if the run is unstable.

    The time in which the script computes the pressure is not included.
    """
    import mujoco
    mujoco.set_mju_user_warning(lambda _: None)
    warnings.simplefilter("ignore")
    model, faces = balloons(balloon, count, triangles, step, integrator)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    seconds, max_depth, stretch = 0, 0, 0
    for i in range(round(duration / step)):
        if balloon.pressure:
            add_pressure(model, data, faces, balloon.pressure)
        start = time.process_time()
        try:
            mujoco.mj_step(model, data)
        except mujoco.FatalError:  # an unstable run may have more contacts than MuJoCo has memory for
            return None
        seconds += time.process_time() - start
        if i % SAMPLED == 0:
            max_depth = max(max_depth, deepest_balloon(data, faces, count))
        stretch = max(stretch, *data.ten_length - 1, 0) if count > 1 else 0
        extent = np.ptp(data.flexvert_xpos.reshape(count, -1, 3), axis=1)
        if any(warning.number for warning in data.warning) or not extent.max() < 4 * RADIUS:
            return None
    return seconds, max_depth, stretch


def fastest(run, *args, rounds):
    """Returns the result of the run with the minimum CPU time, or None if the run is unstable.

    Each run has a process of its own.
    """
    best = in_child(run, *args)
    spent = best[0] if best else 0
    for _ in range(rounds - 1):
        if not best or spent > MAX_SECONDS:
            break
        repeated = in_child(run, *args)
        spent += repeated[0]
        best = min(best, repeated)
    return best


ENGINES = "mujoco bullet rapier drake".split()


def rigid_rows(engines, max_bodies, rounds):
    for engine in engines:
        for problem, layers in HEAPS.items():
            for count in (n for n in (10, 100, 1000) if n <= max_bodies):
                try:
                    seconds, max_depth = fastest(rigid_run, engine, count, layers, rounds=rounds)
                except Exception as fault:  # any exception of an engine is a failed run
                    print(f"{engine}, {problem}, {count}: FAILED, {fault}", flush=True)
                    continue
                yield [engine, problem, count, STEP, f"{seconds / count / (DURATION / STEP) * 1e6:.3f}",
                       f"{DURATION / seconds:.4g}", f"{max_depth:.3e}", ""]


def balloon_rows(rounds):
    for problem, (balloon, count, duration, sizes) in BALLOONS.items():
        for triangles in sizes:
            for integrator in ("euler", "discrete", "ipc"):
                step, found = MAX_STEP, None
                while step >= MIN_STEP and not found:
                    found = fastest(balloon_run, balloon, count, duration, triangles, step, integrator, rounds=rounds)
                    step /= 2
                if found:
                    seconds, max_depth, stretch = found
                    yield [f"mujoco {integrator}", problem, triangles, 2 * step, "", f"{duration / seconds:.4g}",
                           f"{max_depth:.3e}", f"{stretch:.3e}" if count > 1 else ""]


def rows(options, engines):
    if "rigid" in options.problems:
        yield from rigid_rows(engines, options.most, options.rounds)
    if "balloons" in options.problems and "mujoco" in engines:
        yield from balloon_rows(options.rounds)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--out", type=Path, help="default: FOLDER/contact_peers.csv")
    parser.add_argument("--engines", type=lambda s: s.split(","), default=ENGINES)
    parser.add_argument("--problems", type=lambda s: s.split(","), default=["rigid", "balloons"])
    parser.add_argument("--most", type=int, default=1000, help="largest number of bodies")
    parser.add_argument("--rounds", type=int, default=3, help="runs per configuration; the minimum time is written")
    options = parser.parse_args()
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[variable] = "1"
    multiprocessing.set_start_method("spawn")
    options.folder.mkdir(parents=True, exist_ok=True)
    versions = {}
    for engine in options.engines:
        try:
            versions[engine] = in_child(version, engine)
        except (ImportError, importlib.metadata.PackageNotFoundError) as fault:
            print(f"{engine}: SKIPPED, {fault}", flush=True)
    with open(options.out or options.folder / "contact_peers.csv", "w", newline="") as file:
        file.write("# " + ", ".join(f"{engine} {version}" for engine, version in versions.items()) + "\n")
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for row in rows(options, versions):
            table.writerow(row)
            file.flush()
            print(*row, flush=True)


if __name__ == "__main__":
    main()
