"""Valid scenes from a random number: parts of all shapes with deformations, dynamic parameters and local
deformation, with joints, springs, loads and contact, stepped by any method."""

import math
import random

PARAMETERS = {  # lengths of each shape as multiples of a size, and its other parameters with their ranges
    "superellipsoid": (["a1", "a2", "a3"], {"eps1": (0.3, 1.7), "eps2": (0.3, 1.7)}),
    "superellipsoid_radial": (["a1", "a2", "a3"], {"eps1": (0.3, 1.7), "eps2": (0.3, 1.7)}),
    "ellipsoid": (["a1", "a2", "a3"], {}),
    "sphere": (["r"], {}),
    "cylinder": (["a1", "a2", "a3"], {}),
    "cone": (["a1", "a2", "a3"], {"t": (-0.9, 0.9)}),
    "supertoroid": (["a1", "a2", "a3"], {"a4": (2.0, 5.0)}),
    "capsule": (["r", "l"], {}),
    "box": (["a1", "a2", "a3"], {}),
}
DEFORMATIONS = {
    "taper": {"tx": (-0.6, 0.6), "ty": (-0.6, 0.6)},
    "twist": {"angle": (-1.5, 1.5)},
    "bend": {"angle": (-1.2, 1.2), "direction": (-1.5, 1.5)},
    "shear": {"sx": (-0.5, 0.5), "sy": (-0.5, 0.5)},
}
SHELL_LAWS = ["membrane", "st_venant_kirchhoff_membrane", "neo_hookean_membrane"]
BENDING_LAWS = [None, "bending", "folding"]
SOLID_LAWS = ["elastic", "elastic_averaged", "st_venant_kirchhoff", "neo_hookean", "corotated"]
INTEGRATORS = ["auto", "semi_implicit_euler", "rk4", "linearly_implicit", "implicit_midpoint", "esdirk",
               "dormand_prince", "dop853"]
CONTROLLED = ["auto", "esdirk", "dormand_prince", "dop853"]
JOINTS = ["ball", "rod", "string", "plane", "line", "hinge", "slider", "weld"]


class SceneMaker:
    """Draws the values of one scene. The same seed gives the same scene."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def number(self, low, high):
        return float(f"{self.random.uniform(low, high):.4g}")

    def power(self, low, high):
        """Returns a random number from low to high whose logarithm is uniformly distributed."""
        return float(f"{math.exp(self.random.uniform(math.log(low), math.log(high))):.4g}")

    def vector(self, size):
        return [self.number(-size, size) for _ in range(3)]

    def chance(self, probability):
        return self.random.random() < probability

    def parameters(self, shape, deformations, size):
        lengths, others = PARAMETERS[shape]
        values = {name: self.number(0.3 * size, size) for name in lengths}
        values.update({name: self.number(*limits) for name, limits in others.items()})
        for deformation in deformations:
            for name, limits in DEFORMATIONS[deformation].items():
                values[f"{deformation}.{name}"] = self.number(*limits)
        return values

    def make_dynamic(self, values, size, density):
        """Gives some parameters stiffnesses that fit their inertia at frequencies from 1 to 30 Hz."""
        mass = density * size**3
        for name in self.random.sample(sorted(values), k=min(len(values), self.random.randint(1, 3))):
            rate = 2 * math.pi * self.power(1, 30)
            length = name in ("r", "l", "a1", "a2", "a3")
            entry = {"rest": values[name], "stiffness": 0.1 * mass * rate**2 * (1 if length else size**2)}
            if self.chance(0.5):
                entry["initial"] = values[name] * self.number(0.9, 1.1)
            if self.chance(0.15):
                entry.update({"stiffness": 0, "dynamic": True})
            values[name] = entry

    def local(self, shell, size):
        E = self.power(1e3, 1e6)
        if shell:
            thickness = float(f"{0.03 * size:.3g}")
            laws = [{"type": self.random.choice(SHELL_LAWS), "E": E, "thickness": thickness}]
            bending = self.random.choice(BENDING_LAWS)
            if bending:
                laws.append({"type": bending, "E": E, "thickness": thickness})
            if self.chance(0.3):
                laws.append({"type": "pressure", "p": self.number(0, 3e-4) * E})
        else:
            laws = [{"type": self.random.choice(SOLID_LAWS), "E": E, "nu": self.number(0, 0.45)}]
        local = {"resolution": 2, "laws": laws}
        if self.chance(0.5):
            local["beta"] = self.power(1e-5, 1e-3)
        if self.chance(0.5):
            local["dents"] = [{"at": self.vector(size), "radius": size,
                               "displacement": self.vector(0.05 * size), "velocity": self.vector(0.3)}]
        return local

    def part(self, number, position):
        size = self.power(0.03, 0.3)
        shape = self.random.choice(sorted(PARAMETERS))
        chain = self.random.sample(sorted(DEFORMATIONS), k=self.random.choice([0, 0, 0, 1, 1, 2]))
        density = self.power(10, 3000)
        values = self.parameters(shape, chain, size)
        part = {"name": f"p{number}", "shape": shape, "deformations": chain, "parameters": values,
                "density": density, "position": position, "resolution": 2,
                "orientation": {"axis": self.vector(1), "angle": self.number(-3, 3)}}
        kind = self.random.choice(["rigid", "rigid", "rigid", "dynamic", "dynamic", "local"])
        if kind == "dynamic":
            self.make_dynamic(values, size, density)
        if kind == "local":
            part["shell"] = self.chance(0.5)
            part["local"] = self.local(part["shell"], size)
            if part["shell"]:
                part["density"] = density * 0.03 * size
        if self.chance(0.7):
            part["velocity"] = self.vector(2)
        if self.chance(0.5):
            part["angular_velocity"] = self.vector(10)
        if self.chance(0.1):
            part["drag"] = self.number(0, 1)
        if kind == "rigid" and self.chance(0.15):
            part["fixed"] = True
            for key in ("velocity", "angular_velocity"):
                part.pop(key, None)
        return part

    def point(self, parts, other=None):
        names = [part["name"] for part in parts if part["name"] != other]
        if not names or (other and self.chance(0.3)):
            return {"world": self.vector(1)}
        name = self.random.choice(names)
        torus = any(part["name"] == name and part["shape"] == "supertoroid" for part in parts)
        if torus or self.chance(0.3):
            return {"part": name, "at": {"u": self.number(-1.5, 1.5), "v": self.number(-3, 3), "w": 1}}
        return {"part": name, "at": {"direction": self.vector(1)}}

    def joint(self, number, parts):
        start = self.point(parts)
        joint = {"type": self.random.choice(JOINTS), "name": f"j{number}", "from": start,
                 "to": self.point(parts, start.get("part"))}
        if joint["type"] in ("plane", "line", "hinge", "slider"):
            joint["axis"] = self.vector(1)
        return joint

    def contact(self):
        contact = {"friction": self.number(0, 1), "restitution": self.random.choice([0, 0, 0.5, 1])}
        if self.chance(0.8):
            contact["planes"] = [{"name": "floor", "point": [0, 0, self.number(-0.5, 0)]}]
        if self.chance(0.2):
            contact["tolerance"] = self.power(1e-5, 1e-2)
        return contact

    def time(self):
        integrator = self.random.choice(INTEGRATORS)
        time = {"end": self.random.choice([0.1, 0.2, 0.5]), "integrator": integrator}
        if integrator in CONTROLLED and (integrator == "auto" or self.chance(0.6)):
            time["tolerance"] = self.power(1e-8, 1e-3)
        else:
            time["step"] = self.random.choice([1e-4, 5e-4, 1e-3, 2e-3])
        return time

    def scene(self):
        count = self.random.choice([1, 1, 2, 2, 3, 4, 6, 10])
        parts = [self.part(k, [self.number(-0.2, 0.2) + 0.6 * (k % 3), 0.6 * (k // 3 % 2),
                               0.5 + 0.6 * (k // 6)]) for k in range(count)]
        scene = {"parts": parts, "time": self.time()}
        if self.chance(0.3):
            scene["gravity"] = [0, 0, 0]
        if self.chance(0.5):
            scene["contact"] = self.contact()
        if self.chance(0.4):
            scene["joints"] = [self.joint(k, parts) for k in range(self.random.randint(1, max(1, count // 2)))]
        if self.chance(0.3):
            start = self.point(parts)
            scene["springs"] = [{"from": start, "to": self.point(parts, start.get("part")),
                                 "stiffness": self.power(1, 1000), "damping": self.number(0, 1)}]
        return scene


def random_scene(seed):
    """Returns the scene of a seed as a dictionary, ready for json.dump."""
    return SceneMaker(seed).scene()
