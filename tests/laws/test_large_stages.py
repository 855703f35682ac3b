"""Large stages, read without the zeros of their matrices: the same numbers as with dense ones, and those of closed forms."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given

from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.linear_statics.drift import drift
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.loaded import stability as stabilities
from flexstage.analysis.workspace.stroke import StrokeLimits, stroke_limits
from flexstage.analysis.workspace.wrench import corner_wrenches
from flexstage.base.finding import DesignError
from flexstage.base.session import SESSION
from flexstage.base.sparse import Rows, Sparse
from flexstage.beams.compliance import law
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism
from flexstage.models import ideal as ideals
from flexstage.models import lumped as lumpeds
from flexstage.models.linear import eigen
from flexstage.models.linear.block_elimination import eliminate_blocks
from flexstage.models.linear.static import static_gain
from flexstage.parts.body import Body, Inertia
from flexstage.parts.material import Material
from flexstage.parts.notch import Notch
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular
from flexstage.parts.rod import Rod
from flexstage.spatial.frame import COMPONENTS, Frame, axes, twist_transform
from tests.conftest import FULL, examples
from tests.laws.shared import ideal, lumped
from tests.laws.strategies import mechanisms
from tests.laws.test_mechanisms import METRE, platform_compliance, rounding

STEEL = Material(young=200e9, poisson=0.3, density=7800.0, expansion=1.1e-5)
STEP = 0.03
NO_STROKES = StrokeLimits((), np.zeros(0), np.zeros(0))


def sparse_lumped(stage):
    """Without zeros, however small the stage."""
    with patch.object(lumpeds, "LARGE", 0):
        return lumpeds.lumped(stage)


def comparable(matrix):
    return matrix * METRE[:, None] * METRE


@examples(8)
@given(mechanisms())
def test_stages_without_zeros_have_the_same_statics_and_modes(stage):
    dense, sparse = lumped(stage), sparse_lumped(stage)
    if not sparse.is_sparse:
        return
    expected, found = (platform_compliance(model) for model in (dense, sparse))
    slack = 1e-9 + rounding(dense)
    assert np.max(np.abs(found - expected)) <= slack * np.max(np.abs(expected))
    assert np.max(np.abs(found - found.T)) <= slack * np.max(np.abs(found))
    with patch.object(eigen, "ALL_MODES", 0):
        lowest = eigen.lowest_modes(sparse).values[:6]
    every = eigen.eigen(dense).values[: len(lowest)]
    np.testing.assert_allclose(lowest, every, rtol=1e-9 + 2.0 * rounding(dense))


@examples(8)
@given(mechanisms())
def test_stages_eliminated_body_by_body_have_the_same_ideal_motions(stage):
    try:
        expected = ideal(stage)
    except DesignError:
        return
    with patch.object(ideals, "LARGE", 0):
        found = ideals.ideal(stage)
    assert found.coordinates == expected.coordinates
    assert (len(found.idle), len(found.redundant)) == (len(expected.idle), len(expected.redundant))
    for one, other in (
        (found.motion, expected.motion),
        (found.actuation, expected.actuation),
        (found.sensing, expected.sensing),
        (found.bodies, expected.bodies),
    ):
        assert np.max(np.abs(one - other), initial=0.0) <= 1e-9 * np.max(np.abs(other), initial=1.0)


@examples(8)
@given(mechanisms())
def test_load_factors_of_many_freedoms_are_those_of_few(stage):
    try:
        model = lumped(stage)
        expected = stabilities.stability(stage, model)
    except DesignError:
        return
    with patch.object(stabilities, "LARGE", 0):
        found = stabilities.stability.__wrapped__(stage, lumped(stage))
    np.testing.assert_allclose(1.0 / found.dead, 1.0 / expected.dead, rtol=1e-6 + rounding(model), atol=1e-9)


def test_the_worst_strokes_of_many_freedoms_are_those_of_few():
    stage = parallelogram()
    limits = stroke_limits(stage).from_zero
    expected = stabilities.stability(stage, lumped(stage), limits)
    with patch.object(stabilities, "LARGE", 0):
        found = stabilities.stability.__wrapped__(stage, lumped(stage), limits)
    np.testing.assert_allclose((found.worst, found.dead, found.stiffens), (expected.worst, expected.dead, expected.stiffens), rtol=1e-9)
    np.testing.assert_allclose(found.strokes, expected.strokes)
    assert found.moving == expected.moving


def stage_of(parents, places):
    """Bodies that hang on others by rods of one kind, body 0 the platform; a parent -1 is the ground."""
    names = [PLATFORM, *(f"b{number}" for number in range(1, len(parents)))]
    bodies = {name: _body(place) for name, place in zip(names, places, strict=True)}
    links = {}
    for number, parent in enumerate(parents):
        start = np.zeros(3) if parent < 0 else places[parent]
        along = places[number] - start
        middle = tuple(0.5 * (start + places[number]))
        ends = (GROUND if parent < 0 else names[parent], names[number])
        links[f"r{number}"] = Link(ends, "rod", at=middle, along=tuple(along / np.linalg.norm(along)))
    rod = Rod("steel", length=STEP, diameter=0.004)
    return Mechanism("stage", parts={"rod": rod}, materials={"steel": STEEL}, bodies=bodies, links=links, gravity=(0.0, 0.0, 0.0))


def _body(place):
    at = tuple(float(each) for each in place)
    return Body(mass=0.1, centre=at, inertia=Inertia(1e-5, 1e-5, 1e-5), reference=at)


def helix(count):
    """A chain wound as a coil, the platform its end."""
    angles = 0.3 * np.arange(count)
    return np.column_stack([0.1 * np.cos(angles), 0.1 * np.sin(angles), 0.002 * np.arange(count)])


def composed(stage, path):
    """The compliance of the platform (6, 6) as the sum over its path to the ground: X^-1 C X^-T, in the stage's axes."""
    reference = np.array(stage.bodies[PLATFORM].reference)
    own = np.linalg.inv(law(stage.parts["rod"], STEEL).stiffness)
    total = np.zeros((6, 6))
    for name in path:
        link = stage.links[name]
        back = np.linalg.inv(twist_transform(Frame(axes(link.along), np.array(link.at)), reference))
        total += back @ own @ back.T
    return total


@pytest.mark.parametrize("count", [80, 400])
def test_a_chain_has_the_sum_of_its_compliances(count):
    places = helix(count)[::-1]
    stage = stage_of([*range(1, count), -1], places)
    model = lumpeds.lumped(stage)
    assert model.is_sparse
    found, expected = comparable(statics(model).compliance.values), comparable(composed(stage, stage.links))
    assert np.max(np.abs(found - expected)) <= 1e-9 * np.max(np.abs(expected))


def test_a_chain_of_wires_leaves_its_platform_all_motions():
    stage = stage_of([*range(1, 80), -1], helix(80)[::-1])
    found = ideals.ideal(stage)
    assert (found.mobility, len(found.idle), found.redundant) == (6, 6 * 79 - 80, ())


def test_a_chain_of_notches_deforms_least_as_with_dense_matrices():
    count = 90
    stage = stage_of([*range(1, count), -1], helix(count)[::-1])
    links = {name: replace(link, bends=(0.0, 0.0, 1.0)) for name, link in stage.links.items()}
    stage = replace(stage, parts={"rod": Notch("steel", 1e-3, 0.01, Circular(0.003))}, links=links)
    found = ideals.ideal(stage)
    with patch.object(ideals, "LARGE", count + 1):
        SESSION.clear()
        expected = ideals.ideal(stage)
    assert np.max(np.abs(found.bodies - expected.bodies)) <= 1e-10 * np.max(np.abs(expected.bodies))


def test_a_body_that_its_rows_feel_by_rounding_alone_is_idle():
    rows = [Sparse(np.array([6, 12]), np.array([[1e-17, 1.0]]), 18)]
    found = eliminate_blocks(rows, np.ones(18), bodies=3, strokes=0)
    assert (len(found.last.independent), len(found.idle), found.redundant) == (6, 11, ())


def test_a_straight_chain_is_a_row_of_springs_though_rounding_hides_its_stiffness():
    count = 1500 if FULL else 600
    stage = stage_of([*range(1, count), -1], STEP * np.outer(np.arange(count, 0, -1), [1.0, 0.0, 0.0]))
    found, expected = comparable(statics(lumpeds.lumped(stage)).compliance.values), comparable(composed(stage, stage.links))
    assert np.max(np.abs(found - expected)) <= 1e-9 * np.max(np.abs(expected))
    assert abs(found[0, 0] / expected[0, 0] - 1.0) <= 1e-9


def test_a_tree_has_the_compliance_of_its_path_and_drifts_without_stress():
    count = 127
    parents = [-1, *((number - 1) // 2 for number in range(1, count))]
    random = np.random.default_rng(4)
    places = np.zeros((count, 3))
    for number, parent in enumerate(parents):
        step = random.normal(size=3)
        places[number] = (0.0 if parent < 0 else places[parent]) + STEP * step / np.linalg.norm(step)
    order = [3, *(number for number in range(count) if number != 3)]  # the platform in the middle of the tree
    rank = {old: new for new, old in enumerate(order)}
    stage = stage_of([-1 if parents[old] < 0 else rank[parents[old]] for old in order], places[order])
    model = lumpeds.lumped(stage)
    path = [f"r{rank[number]}" for number in (3, 1, 0)]
    found, expected = comparable(statics(model).compliance.values), comparable(composed(stage, path))
    assert np.max(np.abs(found - expected)) <= 1e-9 * np.max(np.abs(expected))
    with patch.object(lumpeds, "LARGE", count + 1):
        dense = drift(stage, lumpeds.lumped(stage), ground="none")
    drifted = drift(stage, model, ground="none")
    for one, other in ((drifted.motion.values, dense.motion.values), (drifted.forces.values, 0.0 * dense.forces.values)):
        assert np.max(np.abs(one - other)) <= 1e-9 * np.max(np.abs(one), initial=1.0)


def test_a_long_chain_grows_about_its_foot_without_turning():
    count = 400
    places = helix(count + 1)[:0:-1]
    stage = stage_of([*range(1, count), -1], places)
    drifted = drift(stage, lumpeds.lumped(stage), ground="none")
    last = stage.links[f"r{count - 1}"]
    foot = np.array(last.at) - 0.5 * STEP * np.array(last.along)
    grown = drifted.of(PLATFORM).values[:, 0]
    np.testing.assert_allclose(grown[:3], STEEL.expansion * (places[0] - foot), rtol=1e-12)
    assert np.max(np.abs(grown[3:])) <= 1e-12 * STEEL.expansion
    assert np.max(np.abs(drifted.forces.values[:, 0])) <= 1e-12 * STEEL.expansion * STEEL.young * 0.004**2


def test_strokes_in_a_long_chain_push_what_is_beyond_by_as_much():
    """Nothing strains: the platform follows a stroke along its axis, and only that."""
    count = 400
    stage = stage_of([*range(1, count), -1], helix(count)[::-1])
    driven = tuple(f"r{number}" for number in (3, count // 2, count - 2))
    links = {name: replace(link, part="stack") if name in driven else link for name, link in stage.links.items()}
    stack = Piezo(stroke=20e-6, stiffness=5e7, length=STEP, diameter=0.01)
    stage = replace(stage, parts={**stage.parts, "stack": stack}, links=links)
    moved = static_gain(lumpeds.lumped(stage), tuple(f"platform.{name}" for name in COMPONENTS), driven).values
    along = np.array([links[name].along for name in driven]).T
    assert np.max(np.abs(moved[:3] - along)) <= 1e-12
    assert np.max(np.abs(moved[3:])) <= 1e-12


def test_modes_of_a_large_stage_are_its_lowest_and_say_so():
    count = 160
    stage = stage_of([*range(1, count), -1], helix(count)[::-1])
    found = modes(lumpeds.lumped(stage))
    with patch.object(lumpeds, "LARGE", count + 1):
        every = modes(lumpeds.lumped(stage))
    assert found.partial
    assert "of 960 degrees of freedom" in found.provenance
    np.testing.assert_allclose(found.frequencies, every.frequencies[: len(found.frequencies)], rtol=1e-6)


def test_what_needs_dense_matrices_is_refused_with_the_size():
    count = 510
    model = lumpeds.lumped(stage_of([*range(1, count), -1], helix(count)[::-1]))
    with pytest.raises(DesignError, match="got 3,060"):
        _ = model.stiffness_matrix


def test_a_factor_without_room_is_refused_with_its_size():
    model = lumpeds.lumped(stage_of([*range(1, 80), -1], helix(80)[::-1]))
    model.__dict__.pop("solver", None)
    with patch("scipy.sparse.linalg.splu", side_effect=MemoryError), pytest.raises(DesignError, match=r"480 equations.*memory"):
        model.solver.solve(np.ones((480, 1)))


def test_what_all_links_feel_takes_no_dense_rows():
    count = 80
    stage = replace(stage_of([*range(1, count), -1], helix(count)[::-1]), gravity=(0.0, 0.0, -9.81))
    links = tuple(stage.links)
    with patch.object(lumpeds, "LARGE", count + 1):
        expected = corner_wrenches(stage, lumpeds.lumped(stage), NO_STROKES, links)
    model = lumpeds.lumped(stage)
    with patch.object(Rows, "__getitem__", side_effect=MemoryError), patch.object(Rows, "__array__", side_effect=MemoryError):
        found = corner_wrenches(stage, model, NO_STROKES, links)
    weight = count * 0.1 * 9.81
    np.testing.assert_allclose(found, expected, atol=1e-6 * weight)


def test_a_part_that_hangs_on_nothing_is_found():
    stage = stage_of([*range(1, 80), -1], helix(80)[::-1])
    with pytest.raises(DesignError, match="singular"):
        lumpeds.lumped(replace(stage, links={name: link for name, link in stage.links.items() if name != "r40"}))


@pytest.mark.full
def test_load_factors_without_zeros_are_found_where_few_eigenvalues_are_apart():
    """Of a stage in which two motions soften and all others are next to zero, Lanczos' method returns those that converge."""
    stage = case("telescope-mount")
    dense = stabilities.stability(stage, lumped(stage)).dead
    with patch.object(stabilities, "LARGE", 0), patch.object(stabilities, "_pieces", stabilities._pieces.__wrapped__):
        sparse = stabilities.stability.__wrapped__(stage, lumped(stage)).dead
    assert sparse == pytest.approx(dense, rel=1e-6)
