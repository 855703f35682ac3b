"""The batched engine against dense LAPACK and Exudyn: designs a second on one core, in one process, in turn.

The shipped stage has 114 freedoms. With its stacks in pieces (two beams a horizontal, three a vertical one, so that each has bending
modes of its own) it has 168. Every design has other thicknesses, radii, widths, positions, turns, sizes of bodies, modulus and density:
30 numbers. "Solving" begins for LAPACK with K and M, for Exudyn with the assembled system, and for the kernel with the numbers of a
design, of which it makes K and M itself; LAPACK finds the six lowest eigenvalues only. "From numbers" begins with the 30 numbers, others
in each round, lest what is kept of designs counts; "fitted" has polynomials over the ranges, fitted once before. Targets: solving 40
times LAPACK, from numbers 50 times.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.linalg import eigh
from threadpoolctl import threadpool_limits

from flexstage.cases.double_triangle import double_triangle
from flexstage.mechanism.addresses.address import set_value
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism, Unit
from flexstage.models.batch.engine import Plan, plan, platform_modes
from flexstage.models.batch.family import numbers_of
from flexstage.models.batch.kernel import kernel, solve_designs
from flexstage.models.lumped import lumped
from flexstage.parts.body import Body

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.elsewhere.exudyn_model import frequencies, system

DESIGNS, ALONE, ROUNDS = 1024, 24, 6
SPREAD = 0.05
TARGETS = {("solving", "kernel"): "40", ("from numbers", "kernel"): "50"}
VARIED = (
    "materials.steel.young",
    "materials.steel.density",
    "parts.neck.thickness",
    "parts.neck.profile.length",
    "parts.neck.width",
    "parts.foot_notch.thickness",
    "parts.foot_notch.width",
    "parts.foot_notch.profile.radius",
    "parts.lever_notch.thickness",
    "parts.lever_notch.width",
    "parts.lever_notch.profile.radius",
    "parts.pole_neck.thickness",
    "parts.pole_neck.profile.radius",
    "bodies.platform.solids.plate.size.x",
    "bodies.platform.solids.plate.size.y",
    "bodies.platform.solids.plate.size.z",
    "placements.B1-B3.pattern.radius",
    "placements.B4-B6.pattern.radius",
    "placements.B4-B6.pattern.height",
    "placements.B4-B6.pattern.turn",
    "units.vertical.links.upper.at.z",
    "units.vertical.links.lower.at.z",
    "units.vertical.links.pivot.at.y",
    "units.horizontal.links.front.at.x",
    "units.horizontal.links.back.at.x",
    "units.vertical.bodies.lever.solids.head.size.x",
    "units.vertical.bodies.lever.solids.saddle.size.z",
    "units.horizontal.bodies.tip.solids.block.size.x",
    "B2/front.thickness",
    "B5/pivot.thickness",
)


def with_pieces(stage: Mechanism, pieces: dict[str, int]) -> Mechanism:
    """The stage with the stack of each unit in so many pieces of equal length, bodies without mass of their own between them."""
    parts, units = dict(stage.parts), dict(stage.units)
    for name, count in pieces.items():
        unit = units[name]
        drive = unit.links["pzt"]
        whole = parts[drive.part]
        piece = f"{drive.part}_piece"
        fraction = {"stroke": whole.stroke / count, "length": whole.length / count, "mass": whole.mass / count, "resonance": None}
        parts[piece] = replace(whole, stiffness=whole.stiffness * count, **fraction)
        along = np.array(drive.along) / np.linalg.norm(drive.along)
        ends = [drive.joins[0], *(f"cut{number}" for number in range(1, count)), drive.joins[1]]
        links = {key: link for key, link in unit.links.items() if key != "pzt"}
        for number in range(count):
            at = np.array(drive.at) + along * whole.length * ((number + 0.5) / count - 0.5)
            links[f"pzt{number + 1}"] = replace(drive, joins=(ends[number], ends[number + 1]), part=piece, at=tuple(at.tolist()))
        units[name] = Unit({**unit.bodies, **{cut: Body() for cut in ends[1:-1]}}, links)
    return replace(stage, parts=parts, units=units, overrides={}, requirements={})


def seconds(actions: dict[str, tuple[int, Callable[[], object]]]) -> dict[str, float]:
    """CPU seconds a design of each (designs, action), run in turn; the least of the rounds, as others use the caches too."""
    runs: dict[str, list[float]] = {label: [] for label in actions}
    for _ in range(ROUNDS + 1):
        for label, (count, action) in actions.items():
            start = time.process_time()
            action()
            runs[label].append((time.process_time() - start) / count)
    return {label: min(each[1:]) for label, each in runs.items()}


def single(family_plan: Plan, values: np.ndarray) -> Mechanism:
    stage = family_plan.family.mechanism
    for address, value in zip(family_plan.family.addresses, values, strict=True):
        stage = set_value(stage, address, float(value))
    return stage


def lapack(stiffness: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    return eigh(stiffness, inertia, subset_by_index=[0, 5], eigvals_only=True, check_finite=False)


def lapack_from(stage: Mechanism) -> np.ndarray:
    model = lumped(stage)
    return lapack(model.stiffness_matrix, model.inertia_matrix)


def compare(label: str, stage: Mechanism) -> None:
    family_plan = plan(stage, VARIED)
    random = np.random.default_rng(0)

    def drawn() -> np.ndarray:
        return family_plan.family.nominal * (1.0 + random.uniform(-SPREAD, SPREAD, size=(DESIGNS, len(VARIED))))

    values = drawn()
    numbers = numbers_of(family_plan.family, values)
    stages = [single(family_plan, each) for each in values[:ALONE]]
    models = [lumped(each) for each in stages]
    peers = [system(each, expand(each)) for each in stages]
    checked(family_plan, values, stages)
    print(f"\n{label}: {6 * len(family_plan.family.topology.bodies)} freedoms, {len(VARIED)} numbers, {DESIGNS} designs")
    solving: dict[str, tuple[int, Callable[[], object]]] = {
        "LAPACK": (ALONE, lambda: [lapack(each.stiffness_matrix, each.inertia_matrix) for each in models]),
        "Exudyn": (ALONE, lambda: [frequencies(each) for each in peers]),
    }
    numbers_on: dict[str, tuple[int, Callable[[], object]]] = {
        "LAPACK": (ALONE, lambda: [lapack_from(each) for each in stages]),
        "Exudyn": (ALONE, lambda: [frequencies(system(each, expand(each))) for each in stages]),
    }
    if (library := kernel()) is not None:
        task = (family_plan.tables, numbers, family_plan.starts[0], family_plan.choice)
        solving["kernel"] = (DESIGNS, lambda: solve_designs(library, *task))
        numbers_on["kernel"] = (DESIGNS, lambda: platform_modes(family_plan, drawn()))
        if (fitted := in_ranges(family_plan, stage)) is not None:
            numbers_on["kernel, fitted"] = (DESIGNS, lambda: platform_modes(fitted, drawn()))
    report("solving", seconds(solving))
    report("from numbers", seconds(numbers_on))


def in_ranges(family_plan: Plan, stage: Mechanism) -> Plan | None:
    """The plan with its features fitted over the ranges that are drawn from."""
    ends = [family_plan.family.nominal * (1.0 + side * SPREAD) for side in (-1.0, 1.0)]
    start = time.process_time()
    found = plan(stage, VARIED, ranges=(np.minimum(*ends), np.maximum(*ends)))
    took = time.process_time() - start
    if found.surface is None:
        print("features cannot be fitted over these ranges")
        return None
    print(f"features fitted in {took:.1f} s, error {found.surface.error:.0e}")
    return found


def checked(family_plan: Plan, values: np.ndarray, stages: list[Mechanism]) -> None:
    """Print how far the engine is from LAPACK on the same designs, and how many of all it proved by iteration."""
    expected = np.array([np.sqrt(lapack_from(each)) / (2.0 * np.pi) for each in stages])
    found = platform_modes(family_plan, values)
    error = np.max(np.abs(found.frequencies[: len(stages)] / expected - 1.0))
    print(f"largest difference from LAPACK {error:.1e}, iterated {np.mean(found.status == 0):.1%}")


def report(title: str, found: dict[str, float]) -> None:
    print(f"{title:24} {'us a design':>12} {'designs/s':>10} {'x LAPACK':>9} {'x Exudyn':>9}")
    for label, each in found.items():
        over = (found["LAPACK"] / each, found["Exudyn"] / each)
        target = TARGETS.get((title, label))
        met = "" if target is None else f"  target {target}"
        print(f"  {label:22} {1e6 * each:12.1f} {1.0 / each:10.0f} {over[0]:9.1f} {over[1]:9.1f}{met}")


def main() -> None:
    print(f"one core, CPU time; kernel: {'none' if (found := kernel()) is None else f'{found.flexstage_width()} designs a vector'}")
    with threadpool_limits(1):
        compare("shipped stage", double_triangle())
        compare("stacks in pieces", with_pieces(double_triangle(), {"horizontal": 2, "vertical": 3}))


if __name__ == "__main__":
    main()
