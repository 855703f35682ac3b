"""A hinge solved by the solid model and by CalculiX: three static loads and six frequencies, time and peak memory of whole processes.

First on one mesh with elements of order two, then ours of order three on a coarser mesh, all held against order four. Each run is a process
of its own on one thread, reading its mesh from a file: ours pays for Python's imports, CalculiX for text. Differences from the reference
are the largest over the three compliances and over the six frequencies. Target: equal to 0.1 % on the equal mesh.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from flexstage.solid.fea.meshing.fineness import Fineness
from flexstage.solid.fea.meshing.mesh import PieceMesh
from tests.elsewhere.calculix.deck import deck, printed_solution, program
from tests.elsewhere.calculix.ours import Law, solved
from tests.elsewhere.calculix.problems import CURVED, Geometry, Problem, Solution, hinge, mesh_of, read_mesh, shape

REPEATS = 2
TARGET = 1e-3
FINE = Fineness(neck=0.5, block=1.0, order=2)
COARSE = Fineness(neck=3.0, block=3.0, order=3)
REFERENCE = Fineness(neck=1.5, block=1.5, order=4)
PERIOD = 0.005
"""Seconds between two looks at a process's memory."""
KILOBYTES = 1024.0
"""In a megabyte."""


@dataclass(frozen=True)
class Cost:
    """Least seconds of some runs of a process, and its largest peak memory [MB]."""

    seconds: float
    memory: float

    def __str__(self) -> str:
        return f"{self.seconds:8.2f} {self.memory:8.0f}"

    def over(self, other: Cost) -> str:
        """Ratios to another cost."""
        return f"{self.seconds / other.seconds:8.2f} {self.memory / other.memory:8.2f}"


def cost(command: Sequence[str], folder: Path) -> Cost:
    """Run a process several times in a folder."""
    runs = [_once(command, folder) for _ in range(REPEATS)]
    return Cost(min(run.seconds for run in runs), max(run.memory for run in runs))


def _once(command: Sequence[str], folder: Path) -> Cost:
    start, peak = time.perf_counter(), 0.0
    with (folder / "log").open("w") as log, subprocess.Popen(command, cwd=folder, stdout=log, stderr=log) as process:
        while process.poll() is None:
            peak = max(peak, _peak(process.pid))
            time.sleep(PERIOD)
    if process.returncode:
        raise RuntimeError(f"{command[0]} ended with {process.returncode}: {(folder / 'log').read_text()[-2000:]}")
    return Cost(time.perf_counter() - start, peak)


def _peak(process: int) -> float:
    """Peak memory of a running process [MB]; what the kernel tells of ended ones includes the parent that started them."""
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
    except (FileNotFoundError, ProcessLookupError):
        return 0.0
    return sum(float(line.split()[1]) / KILOBYTES for line in lines if line.startswith("VmHWM"))


def ours(mesh: PieceMesh, order: int, folder: Path) -> Cost:
    """Our process on a mesh written to a file."""
    mesh.mesh.ngmesh.Save(str(folder / "mesh.vol"))
    return cost([sys.executable, str(Path(__file__).resolve()), str(folder), str(order)], folder)


def theirs(problem: Problem, mesh: PieceMesh, folder: Path) -> tuple[Cost, Solution]:
    """CalculiX's process on a mesh, with what it found."""
    (folder / "job.inp").write_text(deck(problem, mesh))
    spent = cost([str(program()), "-i", str(folder / "job")], folder)
    return spent, printed_solution(problem, mesh, (folder / "job.dat").read_text())


def child(folder: Path, order: int) -> None:
    """What our process does."""
    problem = hinge()
    mesh = read_mesh(folder / "mesh.vol", problem)
    shape(mesh, Geometry("curved", order))
    found = solved(problem, mesh, Law(order))
    np.savez(folder / "ours.npz", compliance=found.compliance, frequencies=found.frequencies)


def found_by_child(folder: Path) -> Solution:
    """What our process found."""
    with np.load(folder / "ours.npz") as stored:
        return Solution(stored["compliance"], stored["frequencies"])


def row(name: str, mesh: PieceMesh, spent: Cost, found: Solution, reference: Solution) -> None:
    """Print one line of the table."""
    compliance, frequency = found.difference(reference)
    print(f"{name:26} {mesh.mesh.ne:9} {spent} {compliance:11.1e} {frequency:11.1e}")


def main() -> None:
    if program() is None:
        print("ccx (Debian calculix-ccx) is not on the PATH: nothing to compare with")
        return
    problem = hinge()
    fine, coarse, finest = (mesh_of(problem, fineness) for fineness in (FINE, COARSE, REFERENCE))
    reference = solved(problem, finest, Law(REFERENCE.order))
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        shape(fine, CURVED)
        second, peer = theirs(problem, fine, folder)
        first, equal = ours(fine, FINE.order, folder), found_by_child(folder)
        third, coarser = ours(coarse, COARSE.order, folder), found_by_child(folder)
    print(f"one thread, least of {REPEATS} runs; {os.cpu_count()} cores")
    print(f"{'':26} {'elements':>9} {'seconds':>8} {'peak MB':>8} {'compliance':>11} {'frequency':>11}")
    row("CalculiX, order 2", fine, second, peer, reference)
    row("flexstage, order 2", fine, first, equal, reference)
    row("flexstage, order 3, coarse", coarse, third, coarser, reference)
    print(f"{'ours over CalculiX, equal':36} {first.over(second)}")
    print(f"{'ours over CalculiX, coarse':36} {third.over(second)}")
    worst = max(equal.difference(peer))
    print(f"equal mesh and order: {worst:.1e} apart; target {TARGET:.0e}: {'met' if worst < TARGET else 'MISSED'}")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        child(Path(sys.argv[1]), int(sys.argv[2]))
    else:
        main()
