"""The lumped model of every shipped case, assembled and solved for its frequencies, against the same model in Exudyn.

Both start from the description and pay for its expansion and the laws of its parts (shown apart as "in both"); they run in turn, many
times, in one process on one thread. Ours also makes what a `LinearModel` holds beyond K and M (inputs, outputs, stress resultants), and
the mode shapes; Exudyn computes shapes too, its assembly is C++. Cases whose links have modes of
their own are left out: in Exudyn they have none. Target: frequencies equal to 1e-8.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import platform
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy
from threadpoolctl import threadpool_info, threadpool_limits

from flexstage.beams.compliance import law
from flexstage.beams.mass import mass
from flexstage.cases.registry import CASES
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.eigen import eigen
from flexstage.models.lumped import lumped

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import exudyn

from tests.elsewhere.exudyn_model import frequencies, of_parts, system

REPEATS = 30
TARGET = 1e-8
HEAD = f" {'least':>7} {'median':>7}"


@dataclass(frozen=True)
class Times:
    """Seconds of each run."""

    runs: list[float]

    def __str__(self) -> str:
        return f"{1e3 * min(self.runs):7.2f} {1e3 * statistics.median(self.runs):7.2f}"

    def ratio(self, other: Times) -> str:
        """Least over least and median over median."""
        return f"{min(self.runs) / min(other.runs):7.2f} {statistics.median(self.runs) / statistics.median(other.runs):7.2f}"


def ours(stage: Mechanism) -> np.ndarray:
    return np.sqrt(eigen(lumped(stage)).values) / (2.0 * np.pi)


def theirs(stage: Mechanism) -> np.ndarray:
    return frequencies(system(stage, expand(stage)))


def shared(stage: Mechanism) -> object:
    """What both need of flexstage: the expansion and the laws of parts."""
    assembly = expand(stage)
    return of_parts(law, assembly), of_parts(mass, assembly)


def has_bodies_alone(stage: Mechanism) -> bool:
    """Whether the coordinates are those of bodies: no link has modes of its own."""
    return all(found.inner is None for found in of_parts(law, expand(stage)).values())


def times(actions: list[Callable[[], object]]) -> list[Times]:
    """Times of several actions, run in turn so that a busy machine slows all alike; two rounds are not counted."""
    runs: list[list[float]] = [[] for _ in actions]
    for _ in range(REPEATS + 2):
        for place, action in enumerate(actions):
            start = time.perf_counter()
            action()
            runs[place].append(time.perf_counter() - start)
    return [Times(each[2:]) for each in runs]


def versions() -> str:
    blas = ", ".join(sorted({f"{pool['internal_api']} {pool['version']} on {pool['num_threads']} thread" for pool in threadpool_info()}))
    codes = f"Exudyn {exudyn.__version__}, numpy {np.__version__}, scipy {scipy.__version__}, Python {platform.python_version()}"
    return f"{codes}; {blas}; {os.cpu_count()} cores; {REPEATS} runs in turn"


def compare(name: str, stage: Mechanism) -> float:
    """Print one line and give the largest relative difference of frequencies."""
    found, expected = ours(stage), theirs(stage)
    difference = float(np.max(np.abs(found / expected - 1.0)))
    first, second, both = times([lambda: ours(stage), lambda: theirs(stage), lambda: shared(stage)])
    print(f"{name:18} {len(found):5} {difference:10.1e} {first} {second} {first.ratio(second)} {both}")
    return difference


def main() -> None:
    with threadpool_limits(1):
        print(versions())
        print(f"{'':18} {'':5} {'largest':>10} {'flexstage ms':>15} {'Exudyn ms':>15} {'ratio':>15} {'in both ms':>15}")
        print(f"{'case':18} {'modes':>5} {'difference':>10}{4 * HEAD}")
        stages = {name: case.build() for name, case in CASES.items()}
        worst = max(compare(name, stage) for name, stage in stages.items() if has_bodies_alone(stage))
    print(f"target: frequencies equal to {TARGET:.0e}: {'met' if worst < TARGET else 'MISSED'}")


if __name__ == "__main__":
    main()
