"""The batched engine against the models one design at a time: on random graphs, with repeated modes, massless bodies and bad designs."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import psutil
import pytest
from hypothesis import given
from hypothesis import strategies as st

import flexstage as fs
from flexstage.base.finding import DesignError
from flexstage.base.processes.native import SWITCH
from flexstage.base.units.scale import X, Y, Z
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import CASES
from flexstage.mechanism.addresses.address import addresses, get, set_value
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism
from flexstage.models.batch.choice import Choice
from flexstage.models.batch.engine import Plan, Status, plan, platform_modes
from flexstage.models.batch.family import numbers_of
from flexstage.models.batch.graph import elimination
from flexstage.models.batch.kernel import Start, kernel, solve_designs
from flexstage.parts.body import Body, Inertia
from flexstage.parts.compliance_matrix import ComplianceMatrix
from tests.conftest import examples
from tests.laws.shared import lumped
from tests.laws.strategies import actuated_platforms, mechanisms, rosettes

needs_kernel = pytest.mark.skipif(kernel() is None, reason="no kernel")
VARIED = ("thickness", "young", "density", "radius", "diameter", "stiffness", "mass")
SHARED = ("parts.neck.thickness", "parts.foot_notch.thickness", "parts.pole_neck.profile.radius", "placements.B1-B3.pattern.radius")
SINGLE = ("B2/front.thickness", "materials.steel.density", "units.vertical.links.upper.at.z", "parts.stack_vertical.mass")


def varied(mechanism: Mechanism, most: int = 8) -> tuple[str, ...]:
    """Some numbers that shape K or M."""
    found = [name for name in addresses(mechanism) if name.rpartition(".")[2] in VARIED and isinstance(get(mechanism, name), float)]
    return tuple(found[:: max(1, len(found) // most)])


def designs(family_plan: Plan, count: int, spread: float, seed: int = 0) -> np.ndarray:
    """Numbers around the plan's own design, which is the first."""
    shift = np.random.default_rng(seed).uniform(-spread, spread, size=(count, len(family_plan.family.addresses)))
    shift[0] = 0.0
    return family_plan.family.nominal * (1.0 + shift)


def one(family_plan: Plan, values: np.ndarray) -> Mechanism:
    result = replace(family_plan.family.mechanism, requirements={})
    for address, value in zip(family_plan.family.addresses, values, strict=True):
        result = set_value(result, address, float(value))
    return result


@given(st.one_of(mechanisms.fresh(), rosettes.fresh(), actuated_platforms.fresh()))
@examples(4)
def test_frequencies_are_those_of_each_design_alone(mechanism: Mechanism) -> None:
    family_plan = plan(mechanism, varied(mechanism))
    values = designs(family_plan, 3, 0.05)
    found = platform_modes(family_plan, values)
    for row, value in zip(found.frequencies, values, strict=True):
        alone = fs.modes(lumped(one(family_plan, value)))
        expected = alone.platform_frequencies
        if len(expected) < 6:
            assert np.isnan(row).all()
        else:
            np.testing.assert_allclose(row, expected, rtol=1e-6)


def dense(family_plan: Plan, values: np.ndarray) -> np.ndarray:
    """The frequencies by dense matrices."""
    found = platform_modes(replace(family_plan, starts=()), values)
    assert (found.status == Status.WHOLE).all()
    return found.frequencies


@needs_kernel
@given(rosettes.fresh())
@examples(6)
def test_iteration_agrees_with_dense_matrices(mechanism: Mechanism) -> None:
    """Rosettes have repeated modes; whatever is proved must be right."""
    family_plan = plan(mechanism, varied(mechanism))
    if not family_plan.starts:
        return
    values = designs(family_plan, 4, 0.1)
    found = platform_modes(family_plan, values)
    proved = found.status == Status.ITERATED
    np.testing.assert_allclose(found.frequencies[proved], dense(family_plan, values[proved]), rtol=1e-6)


@needs_kernel
@pytest.mark.parametrize("names", [SHARED, SHARED + SINGLE])
def test_frequencies_of_the_shipped_stage(names: tuple[str, ...]) -> None:
    """Shared numbers keep the symmetry, and so the pairs; single ones split them."""
    family_plan = plan(double_triangle(), names)
    values = designs(family_plan, 37, 0.05)
    found = platform_modes(family_plan, values)
    assert (found.status == Status.ITERATED).all()
    np.testing.assert_allclose(
        found.frequencies[:9], dense(family_plan, values[:9]), rtol=1e-12
    )  # single modes are found closer than they must be
    np.testing.assert_allclose(found.frequencies[7], fs.modes(fs.lumped(one(family_plan, values[7]))).platform_frequencies, rtol=1e-12)


@needs_kernel
def test_the_kernel_gives_back_all_the_memory_that_it_takes() -> None:
    """Where its table of links stayed, the calls would keep seven times as much."""
    family_plan, library = plan(double_triangle(), ()), kernel()
    assert library is not None
    numbers = numbers_of(family_plan.family, np.zeros((1, 0)))
    taken: list[int] = []
    for _ in range(3):  # the first calls settle what stays with the process
        for _ in range(700):
            solve_designs(library, family_plan.tables, numbers, family_plan.starts[0], family_plan.choice)
        taken.append(psutil.Process().memory_info().rss)
    assert taken[-1] - taken[0] < 8e6


@pytest.mark.parametrize("switch", ["", "off"])
def test_results_do_not_depend_on_how_the_batch_is_cut(switch: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(SWITCH, switch)
    kernel.cache_clear()
    family_plan = plan(double_triangle(), SHARED + SINGLE)
    values = designs(family_plan, 19, 0.2)
    whole = platform_modes(family_plan, values)
    for cut in ((0, 1), (1, 12), (12, 19)):
        piece = platform_modes(family_plan, values[slice(*cut)])
        np.testing.assert_array_equal(piece.frequencies, whole.frequencies[slice(*cut)])
    np.testing.assert_array_equal(platform_modes(family_plan, values[::-1]).frequencies[::-1], whole.frequencies)
    kernel.cache_clear()


def test_fitted_numbers_give_what_each_design_gives() -> None:
    """Over stated ranges numbers are polynomials; outside them, and without them, each design is described by itself.

    No range lets outlines of a body run into one another: their union is no polynomial.
    """
    names = SHARED[:3] + SINGLE + ("materials.steel.young", "bodies.platform.solids.plate.size.x", "placements.B4-B6.pattern.turn")
    plain = plan(double_triangle(), names)
    ends = [plain.family.nominal * factor for factor in (0.9, 1.1)]
    fitted = plan(double_triangle(), names, ranges=(np.minimum(*ends), np.maximum(*ends)))
    assert fitted.surface is not None
    assert fitted.surface.error < 1e-10
    values = designs(plain, 40, 0.1)
    values[7] = 1.2 * plain.family.nominal
    near, exact = (platform_modes(each, values) for each in (fitted, plain))
    np.testing.assert_allclose(near.frequencies, exact.frequencies, rtol=1e-8)
    np.testing.assert_array_equal(near.frequencies[7], exact.frequencies[7])
    np.testing.assert_array_equal(platform_modes(fitted, values[5:23]).frequencies, near.frequencies[5:23])


def test_what_is_not_smooth_over_a_range_is_not_fitted() -> None:
    nominal = plan(double_triangle(), ("parts.neck.thickness",)).family.nominal
    assert plan(double_triangle(), ("parts.neck.thickness",), ranges=(0.02 * nominal, 40.0 * nominal)).surface is None


def test_the_batch_is_the_loop() -> None:
    """The dense path: a stage of few bodies, all designs at once against one at a time."""
    case = CASES["parallelogram"].build()
    family_plan = plan(case, varied(case))
    values = designs(family_plan, 9, 0.1)
    for row, value in zip(dense(family_plan, values), values, strict=True):
        np.testing.assert_allclose(row, fs.modes(lumped(one(family_plan, value))).platform_frequencies, rtol=1e-12)


def test_designs_that_fail_stop_no_other() -> None:
    family_plan = plan(double_triangle(), ("parts.neck.thickness", "parts.stack_vertical.stiffness"))
    good = family_plan.family.nominal
    values = np.array([good, good * [np.nan, 1.0], good * [1.0, 0.0], good * [1.0, -1.0], good * [np.inf, 1.0], good * [1e-4, 1.0]])
    found = platform_modes(family_plan, values)
    assert (found.status[1:5] == Status.NONE).all()
    assert np.isnan(found.frequencies[1:5]).all()
    np.testing.assert_allclose(found.frequencies[0], fs.modes(lumped(double_triangle())).platform_frequencies, rtol=1e-6)
    assert platform_modes(family_plan, values[:0]).frequencies.shape == (0, 6)


def test_designs_that_cannot_be_weighed_stop_no_other() -> None:
    """A side of another metal touches a pole's top: some designs near the nominal one reach into it, and who fills it nobody knows."""
    metals = set_value(double_triangle(), "units.vertical.bodies.pole.solids.left.material", "light")
    metals = replace(metals, materials={**metals.materials, "light": replace(metals.materials["steel"], density=2700.0)})
    names = ("units.vertical.bodies.pole.solids.left.at.y", "units.vertical.bodies.pole.solids.left.size.z")
    family_plan = plan(metals, names)
    values = family_plan.family.nominal * np.array([[1.0, 1.0], [1.01, 1.01], [1.01, 0.99], [1.0, 1.02]])
    found = platform_modes(family_plan, values)
    assert (found.status[[1, 3]] == Status.NONE).all()
    assert np.isnan(found.frequencies[[1, 3]]).all()
    for design in (0, 2):
        alone = fs.modes(lumped(one(family_plan, values[design]))).platform_frequencies
        np.testing.assert_allclose(found.frequencies[design], alone, rtol=1e-6)


@needs_kernel
def test_as_many_platform_frequencies_as_are_wanted() -> None:
    """The first ones; a cluster that is cut is left to dense matrices."""
    for count in (2, 3, 5):
        family_plan = plan(double_triangle(), ("parts.neck.thickness",), Choice(count))
        found = platform_modes(family_plan, family_plan.family.nominal[None])
        assert Status(found.status[0]) is (Status.WHOLE if count == 5 else Status.ITERATED)
        np.testing.assert_allclose(found.frequencies[0], fs.modes(lumped(double_triangle())).platform_frequencies[:count], rtol=1e-6)


def test_local_modes_that_cross_are_not_taken_for_the_platforms() -> None:
    """Lighter casings lower the stacks' own modes through the platform's: which modes are its own is decided design by design."""
    family_plan = plan(double_triangle(), ("parts.stack_horizontal.bending_rigidity", "parts.neck.thickness"))
    values = family_plan.family.nominal * np.array([[1.0, 1.0], [1.0, 0.7], [1.0, 0.8], [1.0, 1.2], [0.5, 0.75], [2.0, 0.72]])
    for row, value in zip(platform_modes(family_plan, values).frequencies, values, strict=True):
        np.testing.assert_allclose(row, fs.modes(lumped(one(family_plan, value))).platform_frequencies, rtol=1e-6)


def test_without_a_kernel_the_results_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    family_plan = plan(double_triangle(), SHARED)
    values = designs(family_plan, 9, 0.05)
    before = platform_modes(family_plan, values)
    monkeypatch.setenv(SWITCH, "off")
    kernel.cache_clear()
    try:
        assert kernel() is None
        after = platform_modes(family_plan, values)
    finally:
        kernel.cache_clear()
    np.testing.assert_allclose(after.frequencies, before.frequencies, rtol=1e-9)
    assert (after.status == Status.WHOLE).all()


def ring(massless: bool) -> Mechanism:
    """Eight bodies in a ring with two diagonals, the platform among them: no tree."""
    soft = tuple(tuple(float(row == column) * (2e-8 if row < 3 else 3e-5) for column in range(6)) for row in range(6))
    names = [PLATFORM, *(f"b{number}" for number in range(1, 8))]
    heavy = Body(mass=9.0, centre=(0.0, 0.0, 0.0), inertia=Inertia(0.1, 0.2, 0.3), reference=(0.0, 0.0, 0.0))
    angles = 2.0 * np.pi * np.arange(8) / 8
    light = Inertia(1e-6, 2e-6, 1e-6)
    bodies = {PLATFORM: heavy}
    for name, angle in zip(names[1:], angles[1:], strict=True):
        centre = (0.1 * float(np.cos(angle)), 0.1 * float(np.sin(angle)), 0.0)
        bodies[name] = Body(reference=centre) if massless else Body(mass=0.01, centre=centre, inertia=light, reference=centre)
    pairs = [(names[number], names[(number + 1) % 8]) for number in range(8)] + [("b1", "b5"), ("b2", "b6")]
    pairs += [(GROUND, "b3"), (GROUND, "b5"), (GROUND, "b7")]
    directions = (X, Y, Z)
    links = {
        f"l{number}": Link(pair, "joint", (0.02 * number - 0.1, 0.05, 0.01 * number), directions[number % 3])
        for number, pair in enumerate(pairs)
    }
    return Mechanism("ring", parts={"joint": ComplianceMatrix(soft, free=(), mass=0.0 if massless else 0.001)}, bodies=bodies, links=links)


@pytest.mark.parametrize("massless", [False, True])
def test_rings_and_massless_bodies(massless: bool) -> None:
    """Their elimination fills in."""
    stage = ring(massless)
    family_plan = plan(stage, ("bodies.platform.mass", "parts.joint.compliance.x.x", "bodies.platform.inertia.xx"))
    assert len(family_plan.tables["later"]) > len([pair for pair in family_plan.family.topology.links if -1 not in pair]) - 1
    values = designs(family_plan, 6, 0.1)
    found = platform_modes(family_plan, values)
    assert massless or kernel() is None or (found.status == Status.ITERATED).all()
    for number in (0, 5):
        alone = fs.modes(lumped(one(family_plan, values[number])))
        np.testing.assert_allclose(found.frequencies[number], alone.platform_frequencies, rtol=1e-6)


@needs_kernel
def test_a_start_without_the_right_modes_is_found_out() -> None:
    """A block that holds nothing of one mode converges to others: counting the pivots' signs tells, and the dense path takes over."""
    family_plan = plan(double_triangle(), ("parts.neck.thickness",))
    first, wider = family_plan.starts
    force = first.force.copy()
    force[:, 3] = force[:, 0] + wider.force[:, -1]  # z: alone of its symmetry among the first
    blind = replace(family_plan, starts=(Start(force, first.shift, first.needed),))
    found = platform_modes(blind, family_plan.family.nominal[None])
    assert Status(found.status[0]) is Status.WHOLE
    np.testing.assert_allclose(found.frequencies[0], fs.modes(lumped(double_triangle())).platform_frequencies, rtol=1e-9)


def test_a_plan_that_was_used_serves_in_another_process() -> None:
    family_plan = plan(double_triangle(), SHARED)
    values = designs(family_plan, 3, 0.05)
    known = platform_modes(family_plan, values)
    handed = pickle.loads(pickle.dumps(family_plan))  # noqa: S301 - our own
    np.testing.assert_array_equal(platform_modes(handed, values).frequencies, known.frequencies)


def test_links_at_the_points_of_their_bodies_have_no_arms() -> None:
    """Nothing is divided by the longest arm where it is nought."""
    parts = {"spring": ComplianceMatrix(tuple(map(tuple, np.diag([1e-6, 1e-6, 1e-6, 1e-3, 1e-3, 1e-3]).tolist())), free=(), mass=0.0)}
    body = Body(mass=1.0, centre=(0.0, 0.0, 0.0), inertia=Inertia(xx=1e-3, yy=1e-3, zz=1e-3))
    stage = Mechanism("point", parts=parts, bodies={PLATFORM: body}, links={"one": Link((GROUND, PLATFORM), "spring", (0.0, 0.0, 0.0), X)})
    found = platform_modes(plan(stage, ()), np.zeros((1, 0)))
    np.testing.assert_allclose(found.frequencies[0], np.sqrt(1e6) / (2.0 * np.pi), rtol=1e-12)


@given(st.integers(2, 9).flatmap(lambda count: st.tuples(st.just(count), st.sets(st.tuples(st.integers(0, 8), st.integers(0, 8))))))
@examples(20)
def test_elimination_orders_any_graph(drawn) -> None:
    count, pairs = drawn
    pairs = {pair for pair in pairs if max(pair) < count}
    found = elimination(count, pairs, keep=0)
    assert sorted(found.order) == list(range(count))
    assert found.order[-1] == 0
    place = {node: position for position, node in enumerate(found.order)}
    wanted = {tuple(sorted((place[first], place[second]))) for first, second in pairs if first != second}
    assert wanted <= set(found.edges)
    assert all(first < later for first, later in found.edges)


def test_what_stays_free_is_refused_by_name() -> None:
    stage = ring(massless=False)
    loose = replace(stage, links={name: link for name, link in stage.links.items() if GROUND not in link.joins})
    with pytest.raises(DesignError, match="stiffness matrix is singular"):
        plan(loose, ("bodies.platform.mass",))
    with pytest.raises(DesignError, match=r'bodies\.platform\.masss: unknown name "masss"\. Use mass\.'):
        plan(stage, ("bodies.platform.masss",))


def test_expansion_is_the_same_for_all() -> None:
    """Overrides of single copies make parts of their own: as many as the description has."""
    names = ("parts.neck.thickness", "B2/front.thickness")
    assert plan(double_triangle(), names).family.topology.parts == 7
    assert len(expand(double_triangle()).links) == 27


@pytest.mark.parametrize(("address", "words"), [("B", "not a number"), ("links.left.at", "several components"), ("nowhere", "nowhere")])
def test_what_is_no_number_is_refused(address: str, words: str) -> None:
    with pytest.raises(DesignError, match=words):
        plan(fs.case("parallelogram"), (address,))
