"""Simbody: ball mobilizers and ball constraints under its error-controlled integrators."""
from functools import partial

import native_peer

DISTRIBUTION = None
PROGRAM = "simbody_peer"


def ladders(problem, folder):
    program = folder / "native" / "simbody_peer"
    path = folder / f"{problem.name}.txt"
    native_peer.write_problem(problem, path)
    tree = "tree" if not problem.tree()[1] else "tree+ball"
    accuracies = [10.0**-k for k in range(1, 13)]
    for method in ("RungeKuttaMerson", "RungeKuttaFeldberg", "CPodesAdams"):
        yield tree, method, accuracies, partial(native_peer.run, program, path, "tree", method)
    if problem.joints:
        method = "RungeKuttaMerson"
        yield "free+ball", method, accuracies, partial(native_peer.run, program, path, "free", method)
