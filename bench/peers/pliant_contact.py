"""pliant: scenes in JSON, simulated by the program bench/scene_states."""
import json
import subprocess

import numpy as np

from contact_problems import DENSITY, FRICTION

INTERVAL = 0.02  # s between two samples


def parameters(body):
    a, b, c = body.half.tolist()
    return {"ball": {"r": a}, "capsule": {"r": a, "l": 2 * c}}.get(body.shape, {"a1": a, "a2": b, "a3": c})


def write_scene(problem, folder, bodies=None):
    """Writes a scene of the problem, or of some of its bodies, to a folder; returns its path."""
    parts = [{"name": f"body{i}", "shape": "sphere" if body.shape == "ball" else body.shape, "density": DENSITY,
              "parameters": parameters(body), "position": body.centre.tolist(),
              "orientation": {"quaternion": body.quaternion.tolist()}, "velocity": body.velocity.tolist(),
              "angular_velocity": body.spin.tolist()} for i, body in enumerate(bodies or problem.bodies)]
    contact = {"friction": FRICTION, "between_parts": problem.touch}
    if problem.bowl:
        problem.bowl.write_obj(folder / "bowl.obj")
        contact["obstacles"] = [{"name": "bowl", "mesh": "bowl.obj"}]
    else:
        contact["planes"] = [{"name": "floor"}]
    path = folder / f"{problem.name}.json"
    path.write_text(json.dumps({"name": problem.name, "time": {"end": problem.end}, "parts": parts, "contact": contact}))
    return path


def run(program, scene, method, kind, value, bodies):
    """Returns (CPU s, samples). kind: step or tolerance."""
    states = scene.with_suffix(".states")
    process = subprocess.run([program, scene, method, kind, repr(value), repr(INTERVAL), states], capture_output=True,
                             text=True)
    if process.returncode:
        raise RuntimeError(process.stderr.strip())
    return float(process.stdout), np.fromfile(states).reshape(-1, bodies, 13)
