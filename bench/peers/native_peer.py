"""What the compiled peers have in common: built once in the working folder, run as a process each."""
import subprocess
from pathlib import Path

import numpy as np

SOURCE = Path(__file__).parent / "native"


def build(folder, prefix):
    """Builds what the machine or the Python environment at prefix has the libraries of."""
    wheels = [str(p) for p in Path(prefix).glob("lib/python*/site-packages/cmeel.prefix")]
    configure = ["cmake", "-S", str(SOURCE), "-B", str(folder),
                 "-DCMAKE_PREFIX_PATH=" + ";".join([str(prefix), *wheels])]
    for command in (configure, ["cmake", "--build", str(folder)]):
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"{' '.join(command)} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")


def write_problem(problem, path):
    """For native/problem.h."""
    def row(*parts):
        return " ".join(repr(float(x)) for part in parts for x in np.atleast_1d(part))

    tree, loops = problem.tree()
    lines = [row(problem.end, problem.gravity), f"{len(problem.bodies)} {len(tree)} {len(loops)}"]
    lines += [row(b.mass, b.inertia, b.pos, b.quat, b.vel, b.omega) for b in problem.bodies]
    lines += [f"{a} {row(ra)} {b} {row(rb)}" for a, ra, b, rb in tree]
    lines += [f"{j.a} {row(j.ra)} {j.b} {row(j.rb)}" for j in loops]
    path.write_text("\n".join(lines) + "\n")


def run(*command):
    """CPU seconds, centres and quaternions at the end."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr.strip() or f"exit status {done.returncode}")
    lines = done.stdout.split("\n")
    pose = np.array([[float(x) for x in line.split()] for line in lines[1:] if line])
    return float(lines[0]), pose[:, :3], pose[:, 3:]
