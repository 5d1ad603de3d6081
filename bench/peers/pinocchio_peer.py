"""Pinocchio: articulated-body algorithm (trees) or constraintDynamics (nets) in compiled Runge-Kutta loops."""
from functools import partial

from scipy.integrate import DOP853

import native_peer

DISTRIBUTION = "pin"
PROGRAM = "pinocchio_peer"

RK4 = [[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1, 0]], [1 / 6, 1 / 3, 1 / 3, 1 / 6], []


def write_tableau(path, A, b, E):
    rows = [f"{len(b)} {len(E)}"] + [" ".join(repr(float(x)) for x in row) for row in [*A, b, *E]]
    path.write_text("\n".join(rows) + "\n")


def ladders(problem, folder):
    program = folder / "native" / "pinocchio_peer"
    path, rk4, dop853 = (folder / name for name in (f"{problem.name}.txt", "rk4.txt", "dop853.txt"))
    native_peer.write_problem(problem, path)
    write_tableau(rk4, *RK4)
    write_tableau(dop853, DOP853.A, DOP853.B, [DOP853.E3, DOP853.E5])
    formulation = "tree" if not problem.tree()[1] else "tree+contact_3d"

    def fixed(tableau, step):
        return native_peer.run(program, path, tableau, "fixed", round(problem.end / step))

    steps = [0.05 / 2**k for k in range(20)]
    yield formulation, "rk4", steps, partial(fixed, rk4)
    yield formulation, "rk8", steps, partial(fixed, dop853)
    tolerances = [10.0**-k for k in range(1, 14)]
    yield formulation, "dop853", tolerances, partial(native_peer.run, program, path, dop853, "adaptive")
