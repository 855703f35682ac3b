"""The shipped stage by substructures and in one mesh: time and memory from nothing, time with the units in the cache, six platform modes.

Each run is a process of its own with the workers it starts; memory is the largest sum over all of them. Both read the same description
with the same fineness at order two, but each draws its own mesh: what the frequencies differ by is the cut and the meshes'. The run in one
mesh takes some minutes and 7 GB. Targets: 3 times less time and memory, 50 times less time from the cache, frequencies within 0.5 %.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

PERIOD = 0.05
"""Seconds between two looks at the memory of the processes."""
MEGABYTE = 1024.0
TIME, CACHED, MEMORY, APART = 3.0, 50.0, 3.0, 5e-3
COUNT = 6


@dataclass(frozen=True, eq=False)
class Run:
    """Seconds of the model alone, peak memory of its processes together [MB], and the platform's frequencies [Hz]."""

    seconds: float
    memory: float
    frequencies: np.ndarray


def run(how: str, folder: Path) -> Run:
    """One model in a process of its own."""
    peak = 0.0
    with subprocess.Popen([sys.executable, str(Path(__file__).resolve()), how, str(folder)]) as process:
        while process.poll() is None:
            peak = max(peak, tree_memory(process.pid))
            time.sleep(PERIOD)
    if process.returncode:
        raise RuntimeError(f"the {how} model ended with {process.returncode}")
    with np.load(folder / f"{how}.npz") as stored:
        return Run(float(stored["seconds"]), peak, stored["frequencies"])


def tree_memory(process: int) -> float:
    """Memory [MB] of a process and all it started."""
    return sum(_memory(each) for each in _tree(process))


def tree_at_work(process: int) -> int:
    """How many processes, of one and all it started, compute or wait for a core."""
    return sum(_state(each) == "R" for each in _tree(process))


def _state(process: int) -> str:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return ""


def _tree(process: int) -> Iterator[int]:
    yield process
    for path in Path(f"/proc/{process}/task").glob("*/children"):
        try:
            children = path.read_text().split()
        except (FileNotFoundError, ProcessLookupError):
            continue
        for child in children:
            yield from _tree(int(child))


def _memory(process: int) -> float:
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
    except (FileNotFoundError, ProcessLookupError):
        return 0.0
    return sum(float(line.split()[1]) / MEGABYTE for line in lines if line.startswith("VmRSS"))


def child(how: str, folder: Path) -> None:
    """What the process of one model does."""
    from flexstage.analysis.modes import modes
    from flexstage.cases.double_triangle import double_triangle
    from flexstage.solid.fea.cache import Cache
    from flexstage.solid.fea.fineness import Fineness, Reduction
    from flexstage.solid.fea.model import model as solid
    from flexstage.solid.fea.monolithic import monolithic

    plan, start = Fineness(order=2), time.perf_counter()
    if how == "monolithic":
        model = monolithic(double_triangle(), Reduction(plan, modes=18), cache=None)
    else:
        model = solid(double_triangle(), Reduction(plan), cache=Cache(folder / "cache"))
    seconds = time.perf_counter() - start
    found = modes(model)
    np.savez(folder / f"{how}.npz", seconds=seconds, frequencies=found.frequencies[list(found.platform[:COUNT])])


def main() -> None:
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        cold, kept, whole = (run(how, folder) for how in ("substructured", "cached", "monolithic"))
    print(f"{os.cpu_count()} cores, order two; platform modes in Hz")
    for how, found in (("substructured", cold), ("from the cache", kept), ("in one mesh", whole)):
        print(f"{how:16} {found.seconds:8.2f} s {found.memory:8.0f} MB  ", " ".join(f"{value:8.3f}" for value in found.frequencies))
    apart = cold.frequencies / whole.frequencies - 1.0
    print(f"{'differences, %':16} {'':22}", " ".join(f"{100.0 * value:8.3f}" for value in apart))
    for what, value, target in (
        ("time, one mesh over substructured", whole.seconds / cold.seconds, TIME),
        ("memory, one mesh over substructured", whole.memory / cold.memory, MEMORY),
        ("time, one mesh over cached", whole.seconds / kept.seconds, CACHED),
    ):
        print(f"{what:38} {value:8.1f}; target {target:g}: {'met' if value >= target else 'MISSED'}")
    worst = float(np.max(np.abs(apart)))
    print(f"{'largest difference, %':38} {100.0 * worst:8.2f}; target {100.0 * APART:g}: {'met' if worst <= APART else 'MISSED'}")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        child(sys.argv[1], Path(sys.argv[2]))
    else:
        main()
