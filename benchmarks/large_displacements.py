"""Equilibria of a leaf guide under 1,500 loads by the kernel in C, by numpy, by Exudyn on the same guide; one case, and a stroke.

Two leaves of 100 x 20 x 0.5 mm; loads along it from -10 to 10, across it from 0 to 20 in units of E I / L^2 and moments from -3 to 3 of
E I / L, each taken at once from rest. Ours has plate action and 30 modes a leaf in space, and finds forces, fields and stiffness besides.
Exudyn (J. Gerstmayr, University of Innsbruck) has plane beams, geometrically exact, 8 a leaf (their least number below 1 % of
error), on a sample of the grid, halving its step by itself where it must. CPU time on one thread, in one process, in turn, the least of
the rounds. Targets: kernel 0.05 ms a case and a fifteenth of Exudyn's, numpy 1 ms, a single case 5 ms, tables of a leaf 5 ms, 41 points
of a stroke on double parallelograms, with frequencies, 1 s. Designs: the force along 21 points and at one, of 32 parallelograms with
their stacks, in one run and each by itself. With `--million` instead: a million states, 240 s of processor, which is two minutes on two
cores.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import itertools
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

import flexstage as fs
from flexstage.analysis.assessment.judge import measure_all
from flexstage.analysis.assessment.requirements import measure
from flexstage.base.processes.native import SWITCH
from flexstage.beams.flexure.law import leaf_law
from flexstage.beams.flexure.strip import fields
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.design import design
from flexstage.models.nonlinear.compiled import kernel
from flexstage.models.nonlinear.stage import Nonlinear

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import exudyn as exu
from exudyn.itemInterface import (
    Force,
    MarkerBodyRigid,
    MarkerNodeRigid,
    NodeRigidBody2D,
    ObjectBeamGeometricallyExact2D,
    ObjectGround,
    ObjectJointGeneric,
    ObjectRigidBody2D,
    Torque,
)

from tests.laws.test_nonlinear import LEAF, STEEL, UNIT, guide

COUNTS, SAMPLE, ELEMENTS, ROUNDS = (10, 15, 10), 25, 8, 4
TARGETS = {"kernel": 0.05, "numpy": 1.0, "single": 5.0, "tables": 5.0, "stroke": 1000.0, "million": 240.0}
MILLION, BLOCK, DESIGNS = 1_000_000, 10_000, 32
Grid = np.ndarray


def grid() -> Grid:
    ranges = [np.linspace(low, high, count) for (low, high), count in zip([(-10, 10), (0, 20), (-3, 3)], COUNTS, strict=True)]
    return np.stack(np.meshgrid(*ranges, indexing="ij"), -1).reshape(-1, 3) * [UNIT, UNIT, UNIT * LEAF.length]


def loads(wrench: Grid) -> dict[str, np.ndarray]:
    return {f"platform.{name}": wrench[:, place] for place, name in enumerate(("fx", "fy", "mz"))}


def in_numpy(action: Callable[[], object]) -> Callable[[], object]:
    def without() -> object:
        os.environ[SWITCH] = "off"
        kernel.cache_clear()
        try:
            return action()
        finally:
            del os.environ[SWITCH]
            kernel.cache_clear()
            kernel()

    return without


def peer(wrench: np.ndarray) -> np.ndarray:
    """Displacement of the platform (2,) by Exudyn; NaN where it finds none."""
    mbs = exu.SystemContainer().AddSystem()
    ground = mbs.AddObject(ObjectGround())
    node = mbs.AddNode(NodeRigidBody2D(referenceCoordinates=[LEAF.length, 0.0, 0.0]))
    platform = mbs.AddObject(ObjectRigidBody2D(nodeNumber=node, mass=1.0, inertia=1.0))
    area = LEAF.width * LEAF.thickness
    shear = STEEL.shear * area / 1.2
    for side in (-0.025, 0.025):
        places = np.linspace(0.0, LEAF.length, ELEMENTS + 1)
        nodes = [mbs.AddNode(NodeRigidBody2D(referenceCoordinates=[place, side, 0.0])) for place in places]
        for pair in itertools.pairwise(nodes):
            mbs.AddObject(
                ObjectBeamGeometricallyExact2D(
                    nodeNumbers=list(pair),
                    length=LEAF.length / ELEMENTS,
                    massPerLength=1.0,
                    crossSectionInertia=1.0,
                    bendingStiffness=UNIT * LEAF.length**2,
                    axialStiffness=STEEL.young * area,
                    shearStiffness=shear,
                )
            )
        for body, place, end in ((ground, [0.0, side, 0.0], nodes[0]), (platform, [0.0, side, 0.0], nodes[-1])):
            markers = [mbs.AddMarker(MarkerBodyRigid(bodyNumber=body, localPosition=place)), mbs.AddMarker(MarkerNodeRigid(nodeNumber=end))]
            mbs.AddObject(ObjectJointGeneric(markerNumbers=markers, constrainedAxes=[1, 1, 0, 0, 0, 1]))
    marker = mbs.AddMarker(MarkerNodeRigid(nodeNumber=node))
    mbs.AddLoad(Force(markerNumber=marker, loadVector=[wrench[0], wrench[1], 0.0]))
    mbs.AddLoad(Torque(markerNumber=marker, loadVector=[0.0, 0.0, wrench[2]]))
    mbs.Assemble()
    return _solved(mbs, node)


def _solved(mbs: exu.MainSystem, node: int) -> np.ndarray:
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.staticSolver.verboseMode = 0
    settings.staticSolver.numberOfLoadSteps = 1
    settings.staticSolver.newton.relativeTolerance = 1e-8
    try:
        mbs.SolveStatic(settings, showHints=False)
    except (RuntimeError, ValueError):
        return np.full(2, np.nan)
    return np.array(mbs.GetNodeOutput(node, exu.OutputVariableType.Displacement))[:2]


def least(actions: dict[str, tuple[int, Callable[[], object]]]) -> dict[str, float]:
    """CPU milliseconds of each (number, action) over its number, run in turn; the least of the rounds."""
    runs: dict[str, list[float]] = {label: [] for label in actions}
    for _ in range(ROUNDS):
        for label, (count, action) in actions.items():
            start = time.process_time()
            action()
            runs[label].append(1e3 * (time.process_time() - start) / count)
    return {label: min(each) for label, each in runs.items()}


def tables() -> object:
    fields.cache_clear()
    return leaf_law(LEAF, STEEL)


def stroke() -> object:
    return fs.stroke(fs.load_path(fs.nonlinear(case("voice-coil-stage")), "platform.x", np.linspace(-1e-3, 1e-3, 41)))


def designs() -> fs.Mechanism:
    """A parallelogram with its stack in thicknesses of which no tables are known."""
    base = replace(parallelogram(), paths={"out": fs.StrokePath("platform.x", ("0 mm", "0.1 mm"), points=21)})
    share = 1.0 + 0.1 * np.random.default_rng().uniform(-1.0, 1.0, DESIGNS)
    return set_value(base, "parts.leaf.thickness", share * np.asarray(get(base, "parts.leaf.thickness")))


def studied(key: str, *, together: bool) -> Callable[[], object]:
    """A measure along a path of all designs, in one run or one by one."""

    def study() -> object:
        batch = designs()
        asked = (measure(batch, key, "here"),)
        return measure_all(batch, asked) if together else [measure_all(design(batch, place), asked) for place in range(DESIGNS)]

    return study


def million(model: Nonlinear) -> None:
    """A million states at random in the ranges of the grid, a block at a time in each of two threads, as the kernel leaves Python alone."""
    scale = np.array([10.0, 20.0, 3.0]) * [UNIT, UNIT, UNIT * LEAF.length]
    random = np.random.default_rng(0)
    blocks = [(random.random((BLOCK, 3)) * [2.0, 1.0, 2.0] - [1.0, 0.0, 1.0]) * scale for _ in range(MILLION // BLOCK)]
    start, wall = time.process_time(), time.perf_counter()
    with ThreadPoolExecutor(2) as pool:
        good = sum(pool.map(lambda block: int(fs.equilibrium(model, loads(block)).converged.sum()), blocks))
    took, waited = time.process_time() - start, time.perf_counter() - wall
    target = f"target {TARGETS['million']:g}: {'met' if took <= TARGETS['million'] else 'MISSED'}"
    print(f"million  {took:9.1f} s of processor, {waited:.1f} s of wall in two threads, {good} found   {target}")


def main() -> None:
    model, wrench = fs.nonlinear(guide()), grid()
    if "--million" in sys.argv:
        million(model)
        return
    sample = wrench[:: len(wrench) // SAMPLE][:SAMPLE]
    found = fs.equilibrium(model, loads(wrench))
    theirs = np.array([peer(each) for each in sample])
    known = np.isfinite(theirs).all(axis=1)
    mine = fs.equilibrium(model, loads(sample)).displacement()[known, :2]
    apart = 1e3 * np.max(np.abs(mine - theirs[known]))
    print(f"{len(wrench)} cases, {int(found.converged.sum())} found at once, {found.iterations.mean():.2f} iterations each")
    print(f"Exudyn {exu.__version__} found {int(known.sum())} of {len(sample)}; its beams differ from plate action by {apart:.2f} mm")
    actions: dict[str, tuple[int, Callable[[], object]]] = {
        "kernel": (len(wrench), lambda: fs.equilibrium(model, loads(wrench))),
        "numpy": (len(wrench), in_numpy(lambda: fs.equilibrium(model, loads(wrench)))),
        "Exudyn": (len(sample), lambda: [peer(each) for each in sample]),
        "single": (1, lambda: fs.equilibrium(model, loads(wrench[700:701]))),
        "tables": (1, tables),
        "stroke": (1, stroke),
        "designs": (DESIGNS, studied("out.force", together=True)),
        "each": (DESIGNS, studied("out.force", together=False)),
        "at one": (DESIGNS, studied("out.force at 0.1 mm", together=True)),
        "each one": (DESIGNS, studied("out.force at 0.1 mm", together=False)),
    }
    if kernel() is None:
        del actions["kernel"]
    took = least(actions)
    for label, value in took.items():
        target = f"target {TARGETS[label]:g}: {'met' if value <= TARGETS[label] else 'MISSED'}" if label in TARGETS else ""
        print(f"{label:8} {value:9.3f} ms   {took['Exudyn'] / value:8.1f} times as fast as Exudyn's case   {target}")


if __name__ == "__main__":
    main()
