"""Common functions of the compiled peers. The peers are built once in the working folder. Each run has its own process."""
import subprocess
from pathlib import Path

import numpy as np

SOURCE = Path(__file__).parent / "native"


def build(folder, prefix):
    """Builds the peers whose libraries are in the system or in the Python environment at prefix."""
    wheels = [str(p) for p in Path(prefix).glob("lib/python*/site-packages/cmeel.prefix")]
    configure = ["cmake", "-S", str(SOURCE), "-B", str(folder),
                 "-DCMAKE_PREFIX_PATH=" + ";".join([str(prefix), *wheels])]
    for command in (configure, ["cmake", "--build", str(folder)]):
        process = subprocess.run(command, capture_output=True, text=True)
        if process.returncode:
            raise RuntimeError(f"{' '.join(command)} failed:\n{process.stdout[-2000:]}{process.stderr[-2000:]}")


def write_problem(problem, path):
    """Writes a problem in the format of native/problem.h."""
    def row(*parts):
        return " ".join(repr(float(x)) for part in parts for x in np.atleast_1d(part))

    tree, loops = problem.tree()
    lines = [row(problem.end, problem.gravity), f"{len(problem.bodies)} {len(tree)} {len(loops)}"]
    lines += [row(b.mass, b.inertia, b.pos, b.quat, b.vel, b.omega) for b in problem.bodies]
    lines += [f"{a} {row(ra)} {b} {row(rb)}" for a, ra, b, rb in tree]
    lines += [f"{j.a} {row(j.ra)} {j.b} {row(j.rb)}" for j in loops]
    path.write_text("\n".join(lines) + "\n")


def run(*command):
    """Returns CPU seconds, and the centres and quaternions at the end."""
    process = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if process.returncode:
        raise RuntimeError(process.stderr.strip() or f"exit status {process.returncode}")
    lines = process.stdout.split("\n")
    pose = np.array([[float(x) for x in line.split()] for line in lines[1:] if line])
    return float(lines[0]), pose[:, :3], pose[:, 3:]
