"""The shipped stage verified at its default accuracy from nothing, then from the cache: processor, wall, how busy two cores are, memory.

Then each unit alone, at its default accuracy, with all that it consists of changed and the rest in the cache.

Each run is a command of its own. Targets: 100 s of processor, 4 GB, both cores 85 % busy; 1 s from the cache; 20 s of processor a unit.
Where others work on the machine too, what is asked of the cores tells more: how many processes compute or wait for a core, two at most.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from substructures import PERIOD, spent, tree_at_work, tree_memory

CORES = 2
SECONDS, MEMORY, BUSY, CACHED, UNIT = 100.0, 4000.0, 0.85, 1.0, 20.0
FLEXSTAGE = str(Path(sys.executable).with_name("flexstage"))
UNITS = {
    "horizontal": ("back.thickness=1.55 mm", "pzt.stiffness=17.1 N/um", "front.thickness=1.55 mm"),
    "vertical": ("back.thickness=0.86 mm", "pzt.stiffness=35.1 N/um", "pivot.thickness=1.01 mm"),
}
"""A number of every component of a unit."""


@dataclass(frozen=True)
class Run:
    """Seconds of processor and wall, peak memory of all processes together [MB], the share of the cores that they could have used."""

    processor: float
    wall: float
    memory: float
    asked: float


def run(folder: Path, *arguments: str) -> Run:
    """One command, with the cache in a folder."""
    before, begun, peak = spent(), time.perf_counter(), 0.0
    asked: list[int] = []
    environment = {**os.environ, "FLEXSTAGE_CACHE": str(folder / "cache")}
    with subprocess.Popen([FLEXSTAGE, *arguments], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        while process.poll() is None:
            peak = max(peak, tree_memory(process.pid))
            asked.append(min(CORES, tree_at_work(process.pid)))
            time.sleep(PERIOD)
    if process.returncode:
        raise RuntimeError(f"{' '.join(arguments)} ended with {process.returncode}")
    return Run(spent() - before, time.perf_counter() - begun, peak, sum(asked) / (CORES * len(asked)))


def main() -> None:
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        stage = str(folder / "stage.toml")
        run(folder, "new", stage)
        cold, kept = (run(folder, "verify", stage) for _ in range(2))
        changes = {unit: [f"--set={unit}/{change}" for change in numbers] for unit, numbers in UNITS.items()}
        run(folder / "units", "solid", stage, "--scope", "unit")
        units = {f"{unit} alone": run(folder / "units", "solid", stage, "--scope", "unit", *change) for unit, change in changes.items()}
    for how, found in {"from nothing": cold, "from the cache": kept, **units}.items():
        print(
            f"{how:16} {found.processor:8.1f} s of processor {found.wall:8.1f} s of wall {found.memory:8.0f} MB; "
            f"{found.asked:.0%} of {CORES} cores asked for"
        )
    busy = cold.processor / (CORES * cold.wall)
    for what, value, target, met in (
        ("processor from nothing, s", cold.processor, SECONDS, cold.processor <= SECONDS),
        ("memory, MB", cold.memory, MEMORY, cold.memory <= MEMORY),
        ("share of two cores", busy, BUSY, busy >= BUSY),
        ("wall from the cache, s", kept.wall, CACHED, kept.wall <= CACHED),
        *((f"{unit}, s", found.processor, UNIT, found.processor <= UNIT) for unit, found in units.items()),
    ):
        print(f"{what:28} {value:8.2f}; target {target:g}: {'met' if met else 'MISSED'}")


if __name__ == "__main__":
    main()
