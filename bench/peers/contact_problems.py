"""Contact problems for every engine: bodies on a plane or in a mesh bowl. Units are SI, z is up."""
import math
from dataclasses import dataclass, field

import numpy as np

DENSITY, FRICTION, GRAVITY = 1000, 0.5, 9.81
RATIOS = 0.6180339887498949, 0.7548776662466927, 0.5698402909980532  # of quasi-random numbers
BLOCK_SPEED = 2.0  # m/s, of the block at the start


@dataclass
class Body:
    """half: semi-axes of an ellipsoid, half sizes of a box, or (radius, radius, half length of the straight side), m.

    velocity: world, m/s; spin: angular velocity, body frame, rad/s; quaternion: w x y z, body to world.
    """
    shape: str  # ellipsoid, ball, box, cylinder or capsule; the axis of the last two is z
    half: np.ndarray
    centre: np.ndarray
    quaternion: np.ndarray = field(default_factory=lambda: np.array([1.0, 0, 0, 0]))
    velocity: np.ndarray = field(default_factory=lambda: np.zeros(3))
    spin: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self):
        self.mass, self.inertia = mass_and_moments(self.shape, self.half)


@dataclass
class Problem:
    name: str
    bodies: list
    end: float
    bowl: object = None  # a Bowl, or None for the plane z = 0
    touch: bool = True  # whether contacts between bodies are active
    meet: bool = False  # whether bodies meet; the motion is then chaotic, and positions are not compared
    finest: int = 7  # steps are 0.02 s / 2^k, k = 0 ... finest


class Bowl:
    """Triangles of the surface z = x^2 + y^2 (m) over a square grid. The four corners of a cell are in one plane, so the
    surface does not depend on the diagonals that divide the cells into triangles.
    """
    half_width, cells = 0.5, 20

    def __init__(self):
        n = self.cells + 1
        self.line = np.linspace(-self.half_width, self.half_width, n)
        x, y = np.meshgrid(self.line, self.line)  # rows: y
        self.heights = x * x + y * y
        self.vertices = np.stack([x.ravel(), y.ravel(), self.heights.ravel()], axis=1)
        corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
        self.triangles = np.concatenate([np.stack([corner, corner + 1, corner + n], axis=1),
                                         np.stack([corner + 1, corner + n + 1, corner + n], axis=1)])

    def write_obj(self, path):
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in self.vertices.tolist()]
        path.write_text("\n".join(lines + [f"f {a} {b} {c}" for a, b, c in (self.triangles + 1).tolist()]) + "\n")

    def gap(self, centres, radius):
        """Returns the distances of balls from the surface, m. centres: (n, 3), m, above the surface or near the surface."""
        spacing = self.line[1] - self.line[0]
        first = np.clip(((centres[:, :2] + self.half_width) / spacing).astype(int), 0, self.cells - 1)
        best = np.full(len(centres), np.inf)
        for column in (-1, 0, 1):
            for row in (-1, 0, 1):
                cell = np.clip(first + (column, row), 0, self.cells - 1)
                best = np.minimum(best, self._gap_of_cell(cell, centres))
        return best - radius

    def _gap_of_cell(self, cell, centres):
        """Returns the distance of each centre from the parallelogram of one cell, m; negative below the plane of the cell."""
        x0, y0 = self.line[cell[:, 0]], self.line[cell[:, 1]]
        x1, y1 = self.line[cell[:, 0] + 1], self.line[cell[:, 1] + 1]
        corner = np.stack([x0, y0, x0 * x0 + y0 * y0], axis=1)
        u = np.stack([x1 - x0, np.zeros_like(x0), x1 * x1 - x0 * x0], axis=1)
        v = np.stack([np.zeros_like(y0), y1 - y0, y1 * y1 - y0 * y0], axis=1)
        normal = np.cross(u, v)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        height = ((centres - corner) * normal).sum(axis=1)
        # The nearest point of the cell is corner + s u + t v. Alternating minimisation over s and t converges fast.
        d, s, t = centres - corner, np.zeros(len(cell)), np.zeros(len(cell))
        uu, vv, uv = (u * u).sum(axis=1), (v * v).sum(axis=1), (u * v).sum(axis=1)
        du, dv = (d * u).sum(axis=1), (d * v).sum(axis=1)
        for _ in range(60):
            s = np.clip((du - t * uv) / uu, 0, 1)
            t = np.clip((dv - s * uv) / vv, 0, 1)
        distance = np.linalg.norm(d - s[:, None] * u - t[:, None] * v, axis=1)
        return np.where(height < 0, -distance, distance)


def mass_and_moments(shape, half):
    """Returns the mass, kg, and the principal moments of inertia about the centre, body axes, kg m^2."""
    a, b, c = half
    if shape in ("ellipsoid", "ball"):
        mass = DENSITY * 4 / 3 * math.pi * a * b * c
        squares = np.array([a * a, b * b, c * c]) / 5
    elif shape == "box":
        mass = DENSITY * 8 * a * b * c
        squares = np.array([a * a, b * b, c * c]) / 3
    elif shape == "cylinder":
        mass = DENSITY * math.pi * a * a * 2 * c
        squares = np.array([a * a / 4, a * a / 4, c * c / 3])
    else:  # capsule: a cylinder and two half balls, whose centres of mass are 3/8 r beyond the ends of the cylinder
        side, ball = DENSITY * math.pi * a * a * 2 * c, DENSITY * 4 / 3 * math.pi * a**3
        mass = side + ball
        across = (side / 4 + ball / 5) * a * a / mass
        along = (side * c * c / 3 + ball * (c * c + 2 * c * 3 / 8 * a + a * a / 5)) / mass
        squares = np.array([across, across, along])
    return mass, mass * (squares.sum() - squares)


def spread(i):
    """Returns three quasi-random numbers in [0, 1)."""
    return np.array([(i + 1) * ratio % 1 for ratio in RATIOS])


def turned(axis, angle):
    axis = np.asarray(axis, float)
    return np.array([math.cos(angle / 2), *math.sin(angle / 2) * axis / np.linalg.norm(axis)])


def product(p, q):
    """Product of two quaternions w x y z."""
    return np.array([p[0] * q[0] - p[1:] @ q[1:], *(p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:]))])


def ellipsoids(count, layers, apart=0.25):
    """Yields ellipsoids side by side or in layers above a plane, as in bench/contact_bench.cpp.

    apart: distance between the places of neighbours, m.
    """
    across = math.ceil(math.sqrt(count / layers))
    for i in range(count):
        random = a, b, c = spread(i)
        layer, place = divmod(i, across * across)
        yield Body("ellipsoid", 0.06 + 0.04 * random,
                   np.array([apart * (place % across) + 0.02 * a, apart * (place // across) + 0.02 * b,
                             0.15 + 0.1 * c + 0.35 * layer]), turned([a - 0.5, b - 0.5, c - 0.4], 6 * a))


def sliding(count):
    """Yields boxes, and cylinders and capsules on their sides, that slide on the plane from the start."""
    for i in range(count):
        a, b, c = spread(i)
        shape = ("box", "cylinder", "capsule")[i % 3]
        heading = turned([0, 0, 1], 2 * math.pi * b)
        speed, place = 0.8 + 1.2 * a, np.array([1.5 * (i % 6), 1.5 * (i // 6), 0])
        if shape == "box":  # a box slides along its first axis, so the friction has no moment about the vertical
            half, pose, towards = 0.04 + 0.04 * np.array([a, b, 0.3 * c]), heading, 2 * math.pi * b
        else:
            half = np.array([0.04 + 0.02 * a] * 2 + [0.06 + 0.04 * c])
            pose, towards = product(heading, turned([0, 1, 0], math.pi / 2)), 2 * math.pi * (b + 0.1 + 0.3 * c)
        up = half[2] if shape == "box" else half[0]
        yield Body(shape, half, place + [0, 0, up], pose, speed * np.array([math.cos(towards), math.sin(towards), 0]))


def in_bowl(count, bowl):
    """Yields balls that fall from a small height, roll and slide in the bowl."""
    for i in range(count):
        a, b, c = spread(i)
        radius, turn, away = 0.03 + 0.02 * a, 2 * math.pi * b, 0.15 + 0.2 * c
        x, y = away * math.cos(turn), away * math.sin(turn)
        yield Body("ball", np.full(3, radius), np.array([x, y, x * x + y * y + 1.4 * radius]),
                   spin=np.array([5 * (a - 0.5), 5 * (c - 0.5), 0]))


def make(name):
    if name == "block":
        half = np.array([0.1, 0.1, 0.05])
        block = Body("box", half, np.array([0, 0, half[2]]), velocity=np.array([BLOCK_SPEED, 0, 0]))
        return Problem(name, [block], 0.6)
    if name == "drop":
        return Problem(name, list(ellipsoids(100, 1, apart=0.6)), 1)  # so far apart that they do not meet
    if name == "slide":
        return Problem(name, list(sliding(30)), 0.6)
    if name == "heap":
        return Problem(name, list(ellipsoids(100, 5)), 1, meet=True, finest=5)
    bowl = Bowl()
    return Problem(name, list(in_bowl(16, bowl)), 0.6, bowl=bowl, touch=False)


NAMES = "block drop slide bowl heap".split()


def sliding_block(t):
    """Returns the exact centre (m) and the kinetic energy (J) of the block at times t (s), from Coulomb's law."""
    body = make("block").bodies[0]
    slowing = FRICTION * GRAVITY
    t = np.minimum(np.asarray(t, float), BLOCK_SPEED / slowing)
    speed = BLOCK_SPEED - slowing * t
    x = BLOCK_SPEED * t - slowing * t * t / 2
    return np.stack([x, 0 * x, 0 * x + body.centre[2]], axis=-1), body.mass * speed * speed / 2
