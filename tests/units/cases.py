"""Short scenes that together use every joint, method, law and kind of contact."""

import itertools

METHODS = ["semi_implicit_euler", "rk4", "linearly_implicit", "implicit_midpoint", "esdirk", "dormand_prince",
           "dop853"]
TILTED = {"axis": [0.3, 1, 0.2], "angle": 0.7}
FLOOR = {"name": "floor", "point": [0, 0, 0]}
BOX = {"a1": 0.11, "a2": 0.23, "a3": 0.07}
TOP = {"direction": [0, 0, 1]}


def timed(end=0.06, step=1e-3, integrator="rk4", **more):
    return {"end": end, "step": step, "integrator": integrator, **more}


def controlled(tolerance, integrator="dormand_prince", end=0.3):
    return {"end": end, "integrator": integrator, "tolerance": tolerance}


def part(name, shape, parameters, **keys):
    return {"name": name, "shape": shape, "parameters": parameters, "density": 730, "resolution": 2, **keys}


def moving(height, **keys):
    """Position and velocities of a body that falls and spins."""
    return {"position": [0.13, -0.21, height], "orientation": TILTED, "velocity": [0.7, -0.3, -1.1],
            "angular_velocity": [3, -2, 5], **keys}


def soft_parameters():
    """A dynamic length and a dynamic angle at its limit."""
    return {"a1": {"rest": 0.2, "stiffness": 3e4, "initial": 0.21, "initial_rate": 0.3}, "a2": 0.15, "a3": 0.4,
            "bend.angle": {"rest": 0, "initial": 0.19, "initial_rate": 4, "stiffness": 40, "min": -0.2, "max": 0.2},
            "taper.tx": {"rest": 0.1, "stiffness": 30}}


def soft_part(name="a", **keys):
    return part(name, "ellipsoid", soft_parameters(), deformations=["taper", "bend"], **keys)


def joints():
    """For each kind of joint: a box on this joint to the world, and a deformable part on the box. Methods alternate."""
    kinds = ["ball", "rod", "string", "plane", "line", "hinge", "slider", "weld"]
    for kind, method in zip(kinds, itertools.cycle(METHODS)):
        between = kind if kind not in ("weld", "slider") else "ball"
        yield f"joint_{kind}", {
            "time": timed(integrator=method),
            "parts": [part("a", "box", BOX, **moving(0)), soft_part("b", position=[0.13, -0.21, -0.9])],
            "joints": [{"type": kind, "from": {"part": "a", "at": TOP}, "to": {"world": [0, 0, 1]}},
                       {"type": between, "from": {"part": "b", "at": TOP},
                        "to": {"part": "a", "at": {"direction": [0, 0, -1]}}}]}


def chains():
    """Rigid chains on ball joints, open joints that close, and a joint that acts for a while."""
    links = [part(f"l{k}", "box", BOX, position=[0.23 * k, 0.02 * k, 0], angular_velocity=[0, 1, 0.2 * k])
             for k in range(4)]
    joints = [{"type": "ball", "from": {"part": f"l{k}", "at": {"near": [-0.11, 0.01, 0]}},
               "to": {"world": [-0.11, 0, 0]} if k == 0 else {"part": f"l{k - 1}", "at": {"near": [0.11, 0, 0]}}}
              for k in range(4)]
    for method in ("semi_implicit_euler", "rk4", "dop853"):
        yield f"chain_{method}", {"time": timed(integrator=method), "parts": links, "joints": joints}
    yield "assembled_chain", {"time": timed(), "parts": links, "joints": joints,
                              "stabilization": {"assembly": "before_start"}}
    hook = {**joints[0], "to": {"world": [0, {"t": [0, 0.02, 0.05], "y": [0, 0.01, 0]}, "0.01 * sin(20 * t)"]},
            "on": 0.01, "off": 0.045}
    yield "joint_for_a_while", {"time": timed(), "parts": links[:1], "joints": [hook]}


def methods():
    """A deformable part on a spring, with loads, damping, and a parameter at its limit."""
    for method in METHODS:
        yield f"limit_{method}", {
            "time": timed(integrator=method), "gravity": [0.3, 0, -9.81],
            "parts": [soft_part(**moving(0), alpha=0.3, beta=1e-4, drag=0.2),
                      part("b", "capsule", {"r": 0.1, "l": 0.3}, position=[1, 0, 0])],
            "springs": [{"from": {"part": "a", "at": TOP}, "to": {"part": "b", "at": TOP}, "stiffness": 900,
                         "damping": 4, "rest_length": 0.4}],
            "forces": [{"part": "b", "at": TOP, "force": ["30 * cos(9 * t)", 0, 5], "frame": "body"}],
            "torques": [{"part": "a", "against": "b", "torque": [0, 3, "2 * t"]}]}


def stiff_motion():
    """Stiff, damped parameters in steps that are too long to resolve their motion: matrices of implicit methods."""
    stiff = {"a1": {"rest": 0.2, "stiffness": 3e8, "initial": 0.2001}, "a2": 0.15, "a3": 0.4,
             "twist.angle": {"rest": 0.1, "stiffness": 2e6, "initial_rate": 1}}
    for method in ("implicit_midpoint", "esdirk"):
        yield f"stiff_{method}", {
            "time": timed(0.01, 1e-3, method),
            "parts": [part("a", "ellipsoid", stiff, deformations=["twist"], beta=1e-4, **moving(0)),
                      part("b", "box", BOX, position=[0, 0, -0.5])],
            "springs": [{"from": {"part": "a", "at": TOP}, "to": {"part": "b", "at": TOP}, "stiffness": 4e6,
                         "damping": 900, "rest_length": 0.3}]}


def rigid_contact():
    """Bodies of every shape fall on a plane and on each other."""
    shapes = [("sphere", {"r": 0.2}), ("box", BOX), ("cylinder", {"a1": 0.2, "a2": 0.2, "a3": 0.1}),
              ("capsule", {"r": 0.1, "l": 0.3}), ("cone", {"a1": 0.2, "a2": 0.2, "a3": 0.2, "t": -0.9}),
              ("ellipsoid", {"a1": 0.2, "a2": 0.15, "a3": 0.1}),
              ("superellipsoid", {"a1": 0.2, "a2": 0.15, "a3": 0.1, "eps1": 0.4, "eps2": 0.6}),
              ("supertoroid", {"a1": 0.07, "a2": 0.07, "a3": 0.07, "a4": 3})]
    for shape, parameters in shapes:
        yield f"falls_{shape}", {
            "time": timed(0.2, 2e-3), "contact": {"restitution": 0.4, "planes": [FLOOR]},
            "parts": [part("a", shape, parameters, **moving(0.25)),
                      part("b", "box", BOX, position=[0.13, -0.21, 0.6], velocity=[0, 0, -3])]}
    boxes = [part(f"b{k}", "box", BOX, position=[0.01 * k, 0, 0.07 + 0.14 * k]) for k in range(4)]
    yield "stack", {"time": timed(0.2, 2e-3), "contact": {"friction": 0.7, "planes": [FLOOR]}, "parts": boxes}
    yield "stack_asleep", {"time": timed(0.3, 2e-3, "semi_implicit_euler"), "parts": boxes,
                           "contact": {"planes": [FLOOR], "sleep": {"speed": 0.05, "after": 0.1}}}
    yield "overlap", {"time": timed(0.1, 2e-3), "contact": {"planes": [FLOOR]},
                      "parts": [part("a", "box", BOX, position=[0, 0, 0.03]),
                                part("b", "sphere", {"r": 0.1}, position=[0.02, 0, 0.15])]}
    yield "moving_plane", {
        "time": timed(0.2, 2e-3), "parts": [part("a", "sphere", {"r": 0.1}, position=[0, 0, 0.1])],
        "contact": {"planes": [{"name": "floor", "point": [0, 0, "0.02 * sin(25 * t)"], "normal": [0.1, 0, 1]}],
                    "obstacles": [{"name": "plate", "half_extents": [0.3, 0.3], "position": [0.2, 0, 0.15],
                                   "orientation": {"axis": [0, 1, 0], "angle": -0.9}}]}}
    yield "soft_parameters_fall", {"time": timed(0.1), "contact": {"planes": [FLOOR]},
                                   "parts": [soft_part(**moving(0.3))]}
    yield "joint_and_contact", {
        "time": timed(0.2, 2e-3), "contact": {"planes": [FLOOR]},
        "parts": [part("a", "box", BOX, **moving(0.3)), soft_part("b", position=[0.13, -0.21, 0.8])],
        "joints": [{"type": "ball", "from": {"part": "a", "at": TOP},
                    "to": {"part": "b", "at": {"direction": [0, 0, -1]}}}]}


def tolerances():
    """Error control, with and without contact and joints."""
    for method in ("esdirk", "dormand_prince", "dop853", "linearly_implicit"):
        yield f"tolerance_{method}", {
            "time": controlled(1e-7, method), "parts": [soft_part(**moving(0)), part("b", "box", BOX)],
            "joints": [{"type": "hinge", "from": {"part": "b", "at": TOP}, "to": {"world": [0, 0, 0.07]}}]}
    for name, shape, parameters in (("ball", "sphere", {"r": 0.2}), ("box", "box", BOX)):
        yield f"tolerance_falling_{name}", {
            "time": controlled(1e-5), "parts": [part("a", shape, parameters, **moving(0.3))],
            "contact": {"friction": 0.3, "tolerance": 1e-6, "planes": [FLOOR]}}


def local_deformation():
    """Every law of solids and shells; soft contact."""
    solid = {"resolution": 2, "beta": 1e-4,
             "dents": [{"at": [0, 0, 0.2], "radius": 0.1, "displacement": [0, 0.002, -0.01], "velocity": [0.2, 0, 0]}]}
    laws = ["elastic", "elastic_averaged", "st_venant_kirchhoff", "neo_hookean", "neo_hookean_log", "corotated"]
    ball = {"a1": 0.2, "a2": 0.2, "a3": 0.2}
    for law, method in zip(laws, itertools.cycle(["rk4", "linearly_implicit", "dop853"])):
        yield f"solid_{law}", {
            "time": timed(0.01, 2.5e-4, method),
            "parts": [part("a", "ellipsoid", ball, **moving(0), local={**solid, "laws": [{"type": law, "E": 2e5}]})]}
    shell = {"E": 1e6, "nu": 0.3, "thickness": 0.003}
    for law in ("membrane", "st_venant_kirchhoff_membrane", "neo_hookean_membrane", "neo_hookean_log_membrane"):
        bending = "folding" if law.startswith("neo") else "bending"
        yield f"shell_{law}", {
            "time": timed(0.01, 2e-4), "parts": [part("a", "ellipsoid", ball, **moving(0), shell=True, thickness=0.003,
            local={**solid, "laws": [{"type": law, **shell}, {"type": bending, **shell},
                                     {"type": "gas", "p0": 300, "p_ext": 290}]})]}
    yield "shell_of_paper", {
        "time": timed(0.01, 2e-4), "parts": [part("a", "ellipsoid", soft_parameters(), deformations=["taper", "bend"],
        shell=True, local={**solid, "laws": [{"type": "loaded_membrane", "w0": 3e5, "w1": 2e4},
                                             {"type": "pressure", "p": 50}]})]}
    for basis in ({"basis": "polynomial", "degree": 3}, {"basis": "modes", "modes": 8}):
        yield f"solid_{basis['basis']}", {
            "time": timed(0.02), "parts": [part("a", "ellipsoid", {"a1": 0.2, "a2": 0.17, "a3": 0.23}, **moving(0),
            local={**solid, **basis, "laws": [{"type": "elastic", "E": 2e5}]})]}
    for method in ("rk4", "linearly_implicit"):
        yield f"soft_contact_{method}", {
            "time": timed(0.02, 5e-4, method), "contact": {"restitution": 0.2, "planes": [FLOOR]},
            "parts": [part("a", "ellipsoid", ball, position=[0, 0, 0.201], velocity=[0.3, 0, -2],
                           local={"resolution": 2, "beta": 1e-4, "laws": [{"type": "neo_hookean", "E": 2e5}]}),
                      part("b", "box", BOX, position=[0, 0, 0.48], velocity=[0, 0, -2])]}
    yield "soft_joints", {
        "time": timed(0.02, 5e-4, "linearly_implicit"),
        "parts": [part("a", "ellipsoid", soft_parameters(), deformations=["taper", "bend"],
                       local={"resolution": 2, "laws": [{"type": "corotated", "E": 2e5}]}),
                  part("b", "box", BOX, position=[0, 0, -0.5])],
        "joints": [{"type": "ball", "from": {"part": "a", "at": TOP}, "to": {"world": [0, 0, 0.4]}},
                   {"type": "ball", "from": {"part": "b", "at": TOP},
                    "to": {"part": "a", "at": {"direction": [0, 0, -1], "patch": 0.15}}}]}


def others():
    """Other ways to give shapes, masses, elasticity and motion."""
    yield "elastic_parameters", {
        "time": timed(0.02), "parts": [part("a", "superellipsoid", {
            "a1": {"rest": 0.12, "dynamic": True}, "a2": 0.06, "a3": {"rest": 0.5, "dynamic": True}, "eps1": 0.5,
            "twist.angle": {"initial": 0.7}, "bend.angle": {"dynamic": True}}, deformations=["twist", "bend"],
            elasticity={"type": "neo_hookean", "E": 6e5, "nu": 0.45}, beta=1e-3)]}
    yield "stiffness_matrix", {
        "time": timed(), "parts": [part("a", "ellipsoid", {
            "a1": {"rest": 0.2, "initial": 0.22}, "a2": 0.15, "a3": 0.4, "shear.sx": {"initial_rate": 2}},
            deformations=["shear"], stiffness_matrix={"parameters": ["a1", "shear.sx"], "K": [[2e4, 300], [300, 90]]})]}
    inertia = {"mass": 3, "moments": [[0.2, 0.01, 0], [0.01, 0.3, 0.02], [0, 0.02, 0.25]], "centre": [0.05, 0, 0.02]}
    a = part("a", "superellipsoid_radial", {"a1": 0.2, "a2": 0.3, "a3": 0.1, "bend_offset.b1": 0.03}, inertia=inertia,
             deformations=["bend_offset"], **moving(0))
    del a["density"]
    b = part("b", "box", BOX, motion={"position": [1, 0, "0.1 * sin(9 * t)"],
                                      "turn": {"axis": [1, 0, 1], "angle": "3 * t"}})
    yield "prescribed_motion", {
        "time": timed(), "parts": [a, b],
        "springs": [{"from": {"part": "a", "at": TOP}, "to": {"part": "b", "at": TOP}, "stiffness": 300}]}


def actuation():
    """Drives and limits of joints and of a parameter, a muscle, sensors and loads that read the state."""
    servo = {"target": "0.4 * sin(20 * t) + 0.1 * height", "stiffness": 2, "damping": 0.03, "max_force": 0.3}
    motor = {"rate": 2, "damping": 3, "force": "-1e3 * rail.position"}
    parts = [part("a", "box", BOX, **moving(0)), soft_part("b", position=[0.13, -0.21, -0.9]),
             part("c", "box", BOX, position=[1, 0, 0]), part("d", "box", BOX, position=[2, 0, 0])]
    parts[1]["parameters"]["taper.tx"]["drive"] = {"target": "0.3 * b.a1", "stiffness": 10, "damping": 0.1}
    joints = [{"type": "ball", "name": "neck", "from": {"part": "a", "at": TOP}, "to": {"world": [0.13, -0.21, 1]},
               "drive": {"target": [0.1, "0.3 * sin(9 * t)", "-0.1 * neck.swing_z_rate"], "stiffness": 3},
               "max_swing": 2},
              {"type": "hinge", "name": "knee", "from": {"part": "b", "at": TOP}, "drive": servo,
               "to": {"part": "a", "at": {"direction": [0, 0, -1]}}, "axis": [0, 1, 0]},
              {"type": "slider", "name": "rail", "from": {"part": "c", "at": TOP}, "to": {"world": [1, 0, 0]},
               "axis": [0, 0, 1], "drive": motor, "limits": [-0.02, 0.03], "restitution": 0.4}]
    yield "actuation", {
        "time": timed(), "parts": parts, "joints": joints,
        "sensors": [{"name": "height", "value": "a.z + 0.01 * knee.rate"}],
        "springs": [{"name": "muscle", "from": {"part": "c", "at": TOP}, "to": {"part": "d", "at": TOP},
                     "stiffness": "300 + 20 * muscle.length", "damping": 0.1,
                     "rest_length": "0.9 - 0.01 * muscle.rate"}],
        "forces": [{"part": "d", "at": TOP, "force": [0, "-3 * d.y - 0.5 * d.vy", 0]}],
        "torques": [{"part": "d", "against": "c", "torque": [0, "-0.1 * d.omega.y", "0.2 * c.z"]}]}


def distributed_forces():
    """Surface and body forces, and a mass distribution."""
    water = {"part": "a", "pressure": "9000 * max(0.1 - z, 0)", "traction": ["-30 * vx * abs(nz)", 0, "40 * X - vn"],
             "resolution": 3}
    yield "distributed_forces", {
        "time": timed(),
        "parts": [soft_part("a", mass_distribution="1 + 0.5 * Z + 0.1 * cos(v)"),
                  part("b", "box", BOX, position=[1, 0, 0])],
        "surface_forces": [water],
        "body_forces": [{"part": "b", "acceleration": ["-9 * x", "-9 * y - 2 * vy", "3 * t"]},
                        {"part": "a", "acceleration": [0, "b.z - y", "0.1 * Y"]}]}


def all_cases():
    """Returns the scenes by name."""
    cases = {}
    for group in (joints, chains, methods, stiff_motion, rigid_contact, tolerances, local_deformation, actuation,
                  distributed_forces, others):
        cases.update(group())
    return cases
