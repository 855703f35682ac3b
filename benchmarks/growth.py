"""How cost grows: models, statics, modes and drift of coiled chains of bodies, a process each; seconds of processor and memory.

    python benchmarks/growth.py [BODIES ...]

What bounds each: expanding the description and the links' operators grow with the bodies; the factor of the stiffness hardly does in
chains and trees; the modes take some 300 solves of it. Below 60 bodies matrices are dense.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import itertools
import subprocess
import sys
import time

SIZES = (10, 30, 100, 300, 1000, 3000, 10000)
STEPS = ("describe", "lumped", "statics", "modes", "drift", "ideal")


def chain(count: int) -> object:
    """A coil of bodies of 0.1 kg, each joined to the next one by a steel rod, the last one the platform."""
    import numpy as np

    import flexstage as fs

    angles = 0.3 * np.arange(count + 1)
    places = np.column_stack([0.1 * np.cos(angles), 0.1 * np.sin(angles), 0.002 * np.arange(count + 1)])
    names = ["ground", *(f"b{number}" for number in range(1, count)), "platform"]
    inertia = fs.Inertia(1e-5, 1e-5, 1e-5)
    bodies = {
        name: fs.Body(mass=0.1, centre=tuple(at), inertia=inertia, reference=tuple(at))
        for name, at in zip(names[1:], places[1:], strict=True)
    }
    links = {}
    for number in range(count):
        along, middle = places[number + 1] - places[number], 0.5 * (places[number + 1] + places[number])
        ends = (names[number], names[number + 1])
        links[f"r{number}"] = fs.Link(ends, "rod", at=tuple(middle), along=tuple(along / np.linalg.norm(along)))
    steel = fs.Material(young=200e9, poisson=0.3, density=7800.0, expansion=1.1e-5)
    rod = fs.Rod("steel", length=0.03, diameter=0.004)
    return fs.Mechanism("coil", materials={"steel": steel}, parts={"rod": rod}, bodies=bodies, links=links, gravity=(0.0, 0.0, 0.0))


def measure(count: int) -> None:
    """The seconds of every step and the memory taken in the end, in one line."""
    import resource

    import flexstage as fs

    times = [time.process_time()]

    def tick() -> None:
        times.append(time.process_time())

    stage = chain(count)
    tick()
    model = fs.lumped(stage)
    tick()
    fs.statics(model)
    tick()
    fs.modes(model)
    tick()
    fs.drift(stage, model, ground="none")
    tick()
    fs.ideal(stage)
    tick()
    spent = [after - before for before, after in itertools.pairwise(times)]
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(f"{count:8,}" + "".join(f"{each:10.2f}" for each in spent) + f"{sum(spent):10.2f}{memory:10.0f}", flush=True)


def main() -> None:
    print(f"{'bodies':>8}" + "".join(f"{each:>10}" for each in STEPS) + f"{'sum [s]':>10}{'[MB]':>10}", flush=True)
    for count in [int(each) for each in sys.argv[1:]] or SIZES:
        subprocess.run([sys.executable, __file__, "--one", str(count)], check=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        measure(int(sys.argv[2]))
    else:
        main()
