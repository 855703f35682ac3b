"""Solids of thin parts: plates by flat elements, their estimated errors, the work of a reduction, announced or refused before it begins."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("ngsolve", reason="the solid model needs flexstage[solid]")

import ngsolve

from flexstage.base.finding import DesignError
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.parts.body import Block, Body
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular
from flexstage.solid.fea.geometry.cad import mirrors_of
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.fea.jobs.memory import Counts, ReductionWork
from flexstage.solid.fea.jobs.parts import Ways, obtain, reduce_jobs
from flexstage.solid.fea.jobs.reducing import MeasureWork, Reduce, fewest_elements
from flexstage.solid.fea.jobs.remote import Limits, workers
from flexstage.solid.fea.jobs.worker import Call
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction, element_size, is_thin
from flexstage.solid.fea.meshing.mesh import mesh_component
from flexstage.solid.fea.solver.component import Component, components
from flexstage.solid.fea.solver.frontal import Fronts, _Front
from flexstage.solid.fea.solver.reduce import reduce_mesh
from flexstage.solid.fea.solver.superelement import Superelement
from flexstage.solid.results.resolution import NOT_ESTIMATED, Resolution, estimates
from flexstage.solid.results.stage import stage_figures
from flexstage.solid.results.verification import stage_rows, stage_solid, verdict
from tests.models.small_solids import COARSE, propped
from tests.models.test_solid_mesh import compliance
from tests.models.test_solid_studies import EMPTY
from tests.unfolded import unfold

MM = 1e-3


def arm(part: Leaf | Notch) -> Mechanism:
    """A block that one hinge holds."""
    size = (10 * MM, float(part.width), max(10 * MM, float(part.width)))
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


STIFF_BLOCK = Body(mass=1.0)


def alone(part: Leaf | Notch) -> Component:
    """One hinge between the ground and a rigid body."""
    stage = arm(part)
    return components(replace(stage, bodies={"platform": STIFF_BLOCK}))[0]


@pytest.mark.parametrize("thickness", [1.0, 0.2, 0.05, 0.005])
def test_a_thin_wide_leaf_is_a_plate(thickness: float) -> None:
    """At 10 to 2000 times its thickness: exact volume, bending between beam and cylindrical bending, twist below Saint-Venant's."""
    length, width, nu, young = 20.0 * MM, 10.0 * MM, 0.33, 71.7e9
    component = alone(leaf(20.0, thickness, 10.0))
    mesh = mesh_component(component, Fineness(order=3))
    assert ngsolve.Integrate(1.0, mesh.mesh) == pytest.approx(200.0 * thickness, rel=1e-9)  # mm^3
    assert mesh.mesh.ne < 3000
    found = np.diag(compliance(component, mesh, 3))
    height = thickness * MM
    beam = np.array([length / (young * width * height), 12.0 * length / (young * width * height**3)])
    assert (1.0 - nu**2) * beam[0] < found[0] < beam[0]
    assert (1.0 - nu**2) * beam[1] < found[5] < beam[1]
    assert found[3] < length / (0.5 * young / (1.0 + nu) * width * height**3 / 3.0 * (1.0 - 0.63 * thickness / 10.0))


def test_flat_elements_agree_with_small_ones() -> None:
    """Within 0.5 %, with a fifth of the elements."""
    component = alone(leaf(8.0, 0.2, 8.0))
    flat, small = (mesh_component(component, Fineness(neck=neck, order=3)) for neck in (1.5, 0.3))
    assert 5 * flat.mesh.ne < small.mesh.ne
    np.testing.assert_allclose(np.diag(compliance(component, flat, 3)), np.diag(compliance(component, small, 2)), rtol=5e-3)


@pytest.mark.parametrize(
    "part",
    [
        leaf(10.0, 0.2, 8.0),
        *(pytest.param(part, marks=pytest.mark.full) for part in (leaf(20.0, 0.2, 10.0), leaf(47.5, 0.625, 25.0), notch(3.0, 0.1, 10.0))),
    ],
)
def test_the_estimate_covers_the_error(part: Leaf | Notch) -> None:
    """Of stiffnesses at order three, against order four: within a factor of three, and never ten times the change that remains."""
    second, third, fourth = (stage_figures(arm(part), Reduction(Fineness(order=order), modes=0)) for order in (2, 3, 4))
    found = estimates(second, third, 3)
    errors = np.array([abs(value / fourth[name] - 1.0) for name, value in third.items() if name in found])
    assert len(errors) > 5
    assert np.all(errors < 3.0 * np.array(list(found.values())))
    assert max(found.values()) < 0.02


def test_the_work_is_counted_from_the_mesh() -> None:
    """Unknowns and factor operations are those of the reduction; a dense front of n unknowns takes n^3 / 3."""
    (component,) = components(arm(leaf(20.0, 0.5, 10.0)))
    jobs = [Reduce(f"{order}", component, Reduction(Fineness(order=order), modes=0)) for order in (2, 3)]
    second, third = MeasureWork(tuple(jobs)).work(Call())
    assert third.freedoms == jobs[1].work(Call()).freedoms
    assert second.freedoms < third.freedoms < 4.0 * second.freedoms
    assert replace(jobs[1], measured=third).seconds() == third.seconds(jobs[1].columns) > second.seconds(jobs[0].columns)
    none = np.zeros(0, dtype=np.int64)
    assert Fronts(none, (_Front(0, 10, none, (), (), ()),)).operations == pytest.approx(30.0**3 / 3.0)


def test_only_thin_wide_flexures_have_flat_elements() -> None:
    """At 35 times the thickness and below, leaves have elements of their thickness and of the order of the blocks, as all other parts."""
    for part, thin in ((leaf(20.0, 0.5, 17.0), False), (leaf(20.0, 0.5, 18.0), True), (leaf(15.0, 0.5, 40.0), False)):
        (component,) = components(arm(part))
        assert is_thin(part) == thin
        sizes = [element_size(piece, Fineness()) / MM for piece in component.pieces if piece.body is None]
        assert sizes == pytest.approx([6.0 if thin else 0.75])
        assert mesh_component(component, Fineness(order=2)).finer.any() == thin


def test_a_thin_leaf_is_cut_across_its_width_only() -> None:
    """One half of the mesh gives the stiffness of the whole; an ordinary leaf is not cut."""
    (component,), plan = components(arm(leaf(10.0, 0.2, 8.0))), Reduction(Fineness(order=2), modes=0)
    side = mesh_component(component, plan.fineness, by_symmetry=True)
    side.mesh.Curve(1)  # images of flat faces
    assert side.mirrors.axes == (2,)
    assert not mirrors_of(components(arm(leaf(10.0, 0.5, 8.0)))[0]).axes
    half, whole = (sum(reduce_mesh(component, mesh, plan).stiffness.values()) for mesh in (side, unfold(side)))
    np.testing.assert_allclose(half, whole, rtol=0, atol=1e-8 * np.abs(whole).max())


def test_thin_and_thick_parts_take_similar_work() -> None:
    thick, thin = (
        MeasureWork((Reduce("", components(arm(part))[0], Reduction()),)).work(Call())[0] for part in (leaf(20, 1, 10), leaf(20, 0.1, 10))
    )
    assert thin.freedoms < 4.0 * thick.freedoms


@pytest.mark.parametrize("part", [leaf(20.0, 0.5, 10.0), leaf(20.0, 0.05, 20.0), notch(3.0, 0.5, 10.0), notch(3.0, 0.3, 20.0)])
def test_no_mesh_has_fewer_elements_than_the_fewest(part: Leaf | Notch) -> None:
    (component,) = components(arm(part))
    mesh = mesh_component(component, Fineness(), by_symmetry=True)
    assert fewest_elements(component, Fineness()) <= mesh.mirrors.copies * mesh.mesh.ne


def test_work_beyond_memory_or_time_is_refused_before_it_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    jobs = reduce_jobs(components(arm(notch(3.0, 0.1, 10.0))), Reduction())
    with pytest.raises(DesignError) as beyond_memory:
        obtain(jobs, Ways(None, limits=Limits(memory=0.8e9)))
    assert "0.1 mm thick and 10 mm wide, 1 to 100" in str(beyond_memory.value)
    assert "Use order 2" in str(beyond_memory.value)
    long = ReductionWork(Counts.of(1.0), 1e8, 1e14)
    monkeypatch.setattr("flexstage.solid.fea.jobs.parts.work_all", lambda todo, done, *_: done(todo[0], (long,)))
    with pytest.raises(DesignError, match=r"takes about .* hours \(at most 60 minutes allowed\)\. Use a lower order"):
        obtain(jobs, Ways(None))


def test_an_interrupted_run_reports_what_it_keeps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One of two results is kept, and only the other one is computed afterwards."""
    jobs, lines, asked = reduce_jobs(components(propped(6e-3, 7e-3)), COARSE), [], []

    def work_all(todo: list[Reduce], done: Callable[[Reduce, Superelement], None], *_: object) -> None:
        if isinstance(todo[0], MeasureWork):
            return
        asked.append(len(todo))
        done(todo[0], EMPTY)
        if len(todo) > 1:
            raise KeyboardInterrupt

    monkeypatch.setattr("flexstage.solid.fea.jobs.parts.work_all", work_all)
    monkeypatch.setattr("flexstage.solid.fea.jobs.parts._measure", lambda todo, _ways: (list(todo), ()))
    ways = Ways(Cache(tmp_path), note=lines.append)
    with pytest.raises(KeyboardInterrupt):
        obtain(jobs, ways)
    assert lines[0].startswith(
        "to do: components at order 2 (2); " + ("2 in parallel, about 4 s of CPU time" if workers(ways.limits) == 2 else "")
    )
    assert "1 of 2 results are kept" in lines[-1]
    assert len(obtain(jobs, ways)) == 2
    assert asked == [2, 1]
