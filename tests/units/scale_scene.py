"""Expresses a scene in other units: multiplies each number that has a dimension by the size of its unit.

The sizes are powers of two, so that no number is rounded. A key that OBJECTS does not list is an error; a new key of a
scene therefore needs an entry here.
"""

import collections
import re

# One metre, one kilogram and one second in the new units. hinges: names of joints whose rate is an angular speed.
Units = collections.namedtuple("Units", "length mass time hinges", defaults=[frozenset()])

NAMED_UNITS = {"N": "kg m / s^2", "Pa": "kg / m s^2"}
LENGTHS = {"r", "l", "a1", "a2", "a3", "b1"}  # the parameters that are lengths; all others have no dimension
SEMI_AXES = {"a1": 1, "a2": 1, "a3": 1}
DEFAULT_LENGTHS = {"superellipsoid": SEMI_AXES, "superellipsoid_radial": SEMI_AXES, "ellipsoid": SEMI_AXES,
                   "cylinder": SEMI_AXES, "cone": SEMI_AXES, "box": SEMI_AXES, "sphere": {"r": 1},
                   "capsule": {"r": 0.5, "l": 1}, "supertoroid": {"a1": 0.25, "a2": 0.25, "a3": 0.25}}

# The keys of each object of a scene with their units. A value is a unit, KEEP for values without unit, or the name of
# another object in brackets.
KEEP = ""
OBJECTS = {
    "scene": {"name": KEEP, "description": KEEP, "gravity": "m/s^2", "time": "[time]", "parts": "[part]",
              "joints": "[joint]", "stabilization": "[stabilization]", "contact": "[contact]",
              "springs": "[spring]", "forces": "[force]", "torques": "[torque]", "surface_forces": "[surface_force]",
              "body_forces": "[body_force]", "tracks": "[track]", "sensors": "[sensor]", "output": "[output]"},
    "time": {"end": "s", "step": "s", "integrator": KEEP, "tolerance": KEEP, "solver": KEEP},
    "part": {"name": KEEP, "shape": KEEP, "deformations": KEEP, "shell": KEEP, "thickness": "m", "local": "[local]",
             # A mass distribution is a factor; its unit is that of an angle, 1.
             "mass": "kg", "mass_matrix": KEEP, "mass_distribution": "rad", "inertia": "[inertia]", "position": "m",
             "orientation": KEEP, "velocity": "m/s", "angular_velocity": "1/s", "fixed": KEEP, "motion": "[motion]",
             "resolution": KEEP, "elasticity": "[law]", "alpha": "1/s", "beta": "s", "drag": "1/s"},
    "local": {"basis": KEEP, "degree": KEEP, "modes": KEEP, "resolution": KEEP, "order": KEEP, "laws": "[law]",
              "alpha": "1/s", "beta": "s", "stiffness_factor": "rad", "dents": "[dent]"},
    "law": {"type": KEEP, "E": "Pa", "nu": KEEP, "thickness": "m", "w0": "N/m^3", "w1": "N/m", "p": "Pa",
            "p0": "Pa", "p_ext": "Pa", "gamma": KEEP},
    "dent": {"at": "m", "radius": "m", "displacement": "m", "velocity": "m/s"},
    "inertia": {"mass": "kg", "moments": "kg m^2", "centre": "m"},
    "motion": {"position": "m", "turn": "[turn]"},
    "turn": {"axis": KEEP, "angle": "rad"},
    "joint": {"type": KEEP, "name": KEEP, "from": "[point]", "to": "[point]", "length": "m", "axis": KEEP,
              "from_axis": KEEP, "rotation": KEEP, "drive": "[turning_drive]", "limits": "rad", "max_swing": "rad",
              "twist_limits": "rad", "restitution": KEEP, "ring": "[ring]", "on": "s", "off": "s"},
    "ring": {"count": KEEP, "radius": "m", "axis": KEEP},
    "turning_drive": {"target": "rad", "rate": "1/s", "stiffness": "N m", "damping": "N m s", "force": "N m",
                      "max_force": "N m"},
    "sliding_drive": {"target": "m", "rate": "m/s", "stiffness": "N/m", "damping": "N s/m", "force": "N",
                      "max_force": "N"},
    "point": {"part": KEEP, "at": "[place]", "world": "m"},
    "place": {"u": KEEP, "v": KEEP, "w": KEEP, "direction": KEEP, "near": "m", "patch": "m"},
    "stabilization": {"rule": KEEP, "rate": "1/s", "stab_alpha": "1/s", "stab_beta": "1/s", "speed": KEEP,
                      "assembly": KEEP, "projection": KEEP},
    "contact": {"friction": KEEP, "restitution": KEEP, "tolerance": KEEP, "longest_step": "s", "interval": "s",
                "sleep": "[sleep]", "planes": "[plane]", "obstacles": "[obstacle]", "pairs": KEEP, "groups": KEEP,
                "impacts": KEEP, "between_parts": KEEP},
    "sleep": {"speed": "m/s", "after": "s"},
    "plane": {"name": KEEP, "point": "m", "normal": KEEP, "on": "s", "off": "s"},
    "obstacle": {"name": KEEP, "mesh": KEEP, "half_extents": "m", "scale": "m", "position": "m",
                 "orientation": KEEP, "on": "s", "off": "s"},
    "spring": {"name": KEEP, "from": "[point]", "to": "[point]", "stiffness": "N/m", "damping": "N s/m",
               "rest_length": "m", "on": "s", "off": "s"},
    "force": {"name": KEEP, "part": KEEP, "at": "[place]", "force": "N", "frame": KEEP},
    "track": {"name": KEEP, "part": KEEP, "at": "[place]"},
    "sensor": {"name": KEEP, "value": "rad"},  # the value keeps its old unit: its factor is that of an angle, 1
    "torque": {"name": KEEP, "part": KEEP, "against": KEEP, "torque": "N m", "frame": KEEP},
    "surface_force": {"name": KEEP, "part": KEEP, "traction": "Pa", "pressure": "Pa", "resolution": KEEP},
    "body_force": {"name": KEEP, "part": KEEP, "acceleration": "m/s^2", "resolution": KEEP},
    "output": {"frame_rate": "1/s"},
}
# Keys for pictures, which are left out.
PICTURES = {"$schema", "//", "coloring", "camera", "light", "ground", "color", "visible", "shown", "size",
            "every_part", "contacts"}
# Units that replace those of OBJECTS for some types of an object.
VARIANTS = {"slider": {"drive": "[sliding_drive]", "limits": "m"}}
# The units of the quantities of the state that formulas read. All others keep their number: angles, sensors, exponents.
SIGNALS = {**dict.fromkeys(["x", "y", "z", "length", "position"], "m"), "rate": "m/s",
           **dict.fromkeys(["vx", "vy", "vz"], "m/s"),
           **dict.fromkeys(["omega.x", "omega.y", "omega.z", "twist_rate", "swing_y_rate", "swing_z_rate"], "1/s")}
# The quantities at the points of surface forces, body forces and mass distributions.
AT_POINTS = {**dict.fromkeys(["x", "y", "z", "X", "Y", "Z"], "m"), **dict.fromkeys(["vx", "vy", "vz", "vn"], "m/s")}
SIGNAL = re.compile(r"[A-Za-z_][A-Za-z_0-9]*(?:\.[A-Za-z_][A-Za-z_0-9]*)*")
# Values with a unit that a scene may leave out.
DEFAULTS = {
    "scene": {"gravity": [0, 0, -9.81], "time": {}, "stabilization": {}, "output": {}},
    "time": {"end": 1},
    "stabilization": {"rate": 10},
    "contact": {"longest_step": 2e-3, "interval": 0.0078125},
    "sleep": {"after": 0.5},
    "obstacle": {"scale": 1},
    "output": {"frame_rate": 25},
}


def size_of_unit(unit, units):
    """The size of a unit such as "kg m / s^2" or "kg^(1/2) m" in the new units."""
    result, sign = 1.0, 1
    for word in re.findall(r"[A-Za-z]+(?:\^(?:\d+|\(1/2\)))?|/", unit):
        if word == "/":
            sign = -1
            continue
        name, _, exponent = word.partition("^")
        if name in NAMED_UNITS:
            size = size_of_unit(NAMED_UNITS[name], units)
        else:
            size = {"m": units.length, "kg": units.mass, "s": units.time, "rad": 1.0}[name]
        result *= size**(sign * (0.5 if exponent == "(1/2)" else int(exponent or 1)))
    return result


def size_of_signal(name, units):
    """The size of the unit of a quantity that a formula reads: t, NAME.QUANTITY, a sensor or input, or a quantity at
    the points of a distributed force. Sensors must not have the names in AT_POINTS."""
    owner, _, quantity = name.partition(".")
    if name == "t":
        return units.time
    if name in AT_POINTS:
        return size_of_unit(AT_POINTS[name], units)
    if quantity == "rate" and owner in units.hinges:
        return 1 / units.time
    if quantity in SIGNALS:
        return size_of_unit(SIGNALS[quantity], units)
    parameter = quantity.removesuffix("_dot")
    return size_of_parameter(parameter, units) / (units.time if parameter != quantity else 1)


def scaled(value, factor, units):
    """A number, a formula of time and state, or a list of them, in the new units."""
    if isinstance(value, str):
        def in_old_units(match):
            size = size_of_signal(match[0], units)
            return match[0] if size == 1 else f"({1 / size!r} * {match[0]})"
        return f"{factor!r} * ({SIGNAL.sub(in_old_units, value)})"
    if isinstance(value, list):
        return [scaled(entry, factor, units) for entry in value]
    if isinstance(value, dict):  # key frames or a sum
        factors = {"t": units.time, "end_rates": factor / units.time}
        return {key: scaled(entry, factors.get(key, factor), units) for key, entry in value.items()}
    return value * factor


def size_of_parameter(name, units):
    return units.length if name.split(".")[-1] in LENGTHS else 1.0


def scaled_parameters(part, units):
    """The parameters of a part; a stiffness is an energy divided by the squared unit of the parameter."""
    energy, result = size_of_unit("N m", units), {}
    for name, value in {**DEFAULT_LENGTHS[part["shape"]], **part.get("parameters", {})}.items():
        size = size_of_parameter(name, units)
        if not isinstance(value, dict) or "t" in value:
            result[name] = scaled(value, size, units)
            continue
        force = energy / size
        factors = {"initial_rate": size / units.time, "stiffness": force / size}
        drive = {"rate": size / units.time, "stiffness": force / size, "damping": force / size * units.time,
                 "force": force, "max_force": force}
        result[name] = {key: scaled(entry, factors.get(key, size), units)
                        for key, entry in value.items() if key not in ("dynamic", "drive")}
        if "dynamic" in value:
            result[name]["dynamic"] = value["dynamic"]
        if "drive" in value:
            result[name]["drive"] = {key: scaled(entry, drive.get(key, size), units)
                                     for key, entry in value["drive"].items()}
    return result


def scaled_stiffness_matrix(matrix, units):
    names, energy = matrix["parameters"], size_of_unit("N m", units)
    sizes = [size_of_parameter(name, units) for name in names]
    return {"parameters": names,
            "K": [[entry * (energy / (sizes[i] * sizes[j])) for j, entry in enumerate(row)]
                  for i, row in enumerate(matrix["K"])]}


def scaled_part(part, materials, units):
    part = {**materials.get(part.get("material"), {}), **part}
    part.pop("material", None)
    if not {"mass", "inertia"} & part.keys():
        per_area = part.get("shell", False) and "thickness" not in part
        part["density"] = part.get("density", 1000) * size_of_unit("kg/m^2" if per_area else "kg/m^3", units)
    own = {"density": part.pop("density", None), "parameters": scaled_parameters(part, units)}
    part.pop("parameters", None)
    if "stiffness_matrix" in part:
        own["stiffness_matrix"] = scaled_stiffness_matrix(part.pop("stiffness_matrix"), units)
    return {**scaled_object("part", part, units), **{key: value for key, value in own.items() if value is not None}}


def scaled_object(kind, values, units):
    if isinstance(values, list):
        return [scaled_object(kind, entry, units) for entry in values]
    result = {}
    for key, value in {**DEFAULTS.get(kind, {}), **values}.items():
        if key in PICTURES:
            continue
        unit = VARIANTS.get(values.get("type"), {}).get(key) or OBJECTS[kind][key]
        if unit.startswith("["):
            result[key] = scaled_object(unit[1:-1], value, units)
        elif unit == KEEP:
            result[key] = value
        else:
            result[key] = scaled(value, size_of_unit(unit, units), units)
    return result


def scale_scene(scene, units):
    """Returns the scene in the new units."""
    materials = scene.get("materials", {})
    units = units._replace(hinges={joint.get("name") for joint in scene.get("joints", []) if joint["type"] == "hinge"})
    scene = {key: value for key, value in scene.items() if key != "materials"}
    parts = [scaled_part(part, materials, units) for part in scene.pop("parts")]
    return {**scaled_object("scene", scene, units), "parts": parts}
