"""Solids of thin parts: no error is estimated from elements that lock; work beyond memory or time is refused before it begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.parts.body import Block, Body
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular
from flexstage.solid.fea.jobs.memory import Counts, freedoms
from flexstage.solid.fea.jobs.parts import Ways
from flexstage.solid.fea.jobs.reducing import Reduce, fewest_elements
from flexstage.solid.fea.jobs.remote import Limits
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.fea.meshing.mesh import mesh_component
from flexstage.solid.fea.solver.component import components
from flexstage.solid.results.plan import reduction_plan
from flexstage.solid.results.resolution import NOT_ESTIMATED, Resolution
from flexstage.solid.results.verification import stage_rows, stage_solid, verdict

MM = 1e-3


def arm(part: Leaf | Notch) -> Mechanism:
    """A block that one hinge holds."""
    size = (10 * MM, float(part.width), 10 * MM)
    block = Block("al", size, (0.5 * float(part.span) + 5 * MM, 0.0, 0.0))
    link = Link(("ground", "platform"), "hinge", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    material = Material(young=71.7e9, poisson=0.33, density=2810.0)
    return Mechanism("arm", {"al": material}, {"hinge": part}, {"platform": Body(solids={"arm": block})}, {"hinge": link})


def leaf(length: float, thickness: float, width: float) -> Leaf:
    return Leaf("al", length * MM, thickness * MM, width * MM)


def notch(radius: float, thickness: float, width: float) -> Notch:
    return Notch("al", thickness * MM, width * MM, Circular(radius * MM))


@pytest.mark.full
def test_no_error_is_estimated_from_elements_that_lock() -> None:
    """At order two, which is within 4 % of order three; order one is several times too stiff."""
    stage = arm(leaf(10.0, 0.5, 5.0))
    found, better = (stage_solid(stage, Resolution(order=order)) for order in (2, 3))
    rows = tuple(stage_rows(stage, stage, found))
    assert {"platform mode 1", "in-plane stiffness (softest), others free"} <= set(found.unestimated)
    assert np.isinf(found.error)
    assert not better.unestimated
    for name, error in found.errors.items():
        assert abs(found.result.figures[name] / better.result.figures[name] - 1.0) <= 2.0 * error <= 0.25  # an estimate, no bound
    for name in found.unestimated:
        assert found.result.figures[name] == pytest.approx(better.result.figures[name], rel=0.04)
    unknown = [row for row in rows if row.fea_error is None]
    assert len(unknown) >= len(found.unestimated)
    assert all((row.trust, row.reason) == (None, NOT_ESTIMATED) for row in unknown if row.theory is not None)
    assert "Use --order 3" in verdict(rows)


@pytest.mark.parametrize(
    "part", [leaf(20.0, 0.5, 10.0), leaf(20.0, 0.4, 20.0), notch(3.0, 0.5, 10.0), notch(3.0, 0.3, 20.0), notch(10.0, 0.5, 10.0)]
)
def test_unknowns_of_thin_parts_are_foreseen(part: Leaf | Notch) -> None:
    """However wide they are, within a factor of two; no mesh has fewer elements than the fewest."""
    (component,) = components(arm(part))
    for order in (2, 3):
        fineness = Fineness(order=order)
        mesh = mesh_component(component, fineness, by_symmetry=True)
        sides, raw = mesh.mirrors.copies, mesh.mesh
        counted = Counts(raw.nv, raw.nedge, raw.nface, raw.ne).enriched(float(np.mean(mesh.finer)), order)
        expected = Reduce("", component, Reduction(fineness)).expected(fineness)
        assert fewest_elements(component, fineness) <= sides * raw.ne
        assert 0.5 < freedoms(expected, order) / (sides * freedoms(counted, order)) < 3.0


def test_work_beyond_memory_or_time_is_refused_before_it_begins() -> None:
    stage = arm(notch(3.0, 0.05, 10.0))
    with pytest.raises(DesignError) as beyond_memory:
        reduction_plan([stage], Resolution(), Ways(limits=Limits(memory=16e9)))
    with pytest.raises(DesignError, match="are allowed"):
        reduction_plan([stage], Resolution(), Ways(limits=Limits(memory=1e12, seconds=60.0)))
    assert "0.05 mm thick and 10 mm wide, 1 to 200" in str(beyond_memory.value)
    assert "Use order 2" in str(beyond_memory.value)
    thicker = replace(stage, parts={"hinge": notch(3.0, 0.3, 10.0)})
    assert len(reduction_plan([thicker], Resolution(), Ways(limits=Limits(memory=16e9))).jobs) == 2
