"""The batched engine against the models one design at a time: on random graphs, with repeated modes, massless bodies and bad designs."""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np
import psutil
import pytest
from hypothesis import given
from hypothesis import strategies as st

import flexstage as fs
from flexstage.base.finding import DesignError
from flexstage.base.units.scale import X, Y, Z
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import CASES
from flexstage.mechanism.addresses.address import addresses, get, set_value
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism
from flexstage.models.batch.blocks import blocks, dense
from flexstage.models.batch.choice import Choice
from flexstage.models.batch.compiled import Tables, by_kernel
from flexstage.models.batch.engine import Method, Plan, Status, iterate, plan, plan_family, platform_modes
from flexstage.models.batch.kernel import kernel
from flexstage.models.batch.order import elimination
from flexstage.models.batch.parameters.features import PORTION, Feature, Rows
from flexstage.models.batch.parameters.numbers import Family, Slopes, drawn_family, numbers_and_slopes, numbers_of, slopes_of
from flexstage.models.batch.parameters.units import _told
from flexstage.models.batch.solution import Stage, by_iteration, wholly
from flexstage.parts.body import Body, Inertia
from flexstage.parts.compliance_matrix import ComplianceMatrix
from tests.conftest import examples
from tests.laws.shared import lumped
from tests.laws.strategies import actuated_platforms, mechanisms, rosettes

METHODS = tuple(Method)
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


def check_numbers(family: Family, values: np.ndarray) -> None:
    """Real parts of what is stepped are what is not stepped, where a number is nought, too."""
    with np.errstate(all="ignore"):
        beside, alone = numbers_and_slopes(family, values)[0], numbers_of(family, values)
    for place in family.topology.features:
        scale = np.max(np.abs(alone[place.slots]), axis=0, where=np.isfinite(alone[place.slots]), initial=0.0)
        assert np.array_equal(np.isfinite(beside[place.slots]), np.isfinite(alone[place.slots]))
        assert not np.any(np.abs(beside[place.slots] - alone[place.slots]) > 1e-12 * scale)


@given(st.one_of(mechanisms.fresh(), rosettes.fresh()))
@examples(6, 400)
def test_numbers_told_beside_derivatives_are_those_told_alone(mechanism: Mechanism) -> None:
    family_plan = plan(mechanism, varied(mechanism))
    check_numbers(family_plan.family, designs(family_plan, 3, 0.05))


def test_numbers_told_beside_derivatives_are_those_of_designs_with_noughts() -> None:
    names = ("parts.neck.thickness", "parts.stack_vertical.stiffness", "placements.B4-B6.pattern.turn", "placements.B1-B3.pattern.radius")
    own = plan(double_triangle(), names).family
    check_numbers(own, np.where(np.eye(5, len(names), k=-1), 0.0, own.nominal))


def stage_of(family_plan: Plan, values: np.ndarray) -> Stage:
    numbers = numbers_of(family_plan.family, values)
    return Stage(family_plan.scheme, numbers, values.shape[1], slopes_of(family_plan.family, values))


def check_matrices(mechanism: Mechanism) -> None:
    family_plan = plan(mechanism, varied(mechanism))
    if family_plan.family.topology.locked:
        return
    values = designs(family_plan, 2, 0.05)
    found = blocks(family_plan.scheme, numbers_of(family_plan.family, values))
    model = lumped(one(family_plan, values[1]))
    for mine, theirs in zip(found, (model.stiffness_matrix, model.inertia_matrix), strict=True):
        assert np.max(np.abs(dense(family_plan.scheme, mine)[1] - theirs)) <= 1e-12 * np.max(np.abs(theirs))


@given(st.integers(1, 3 * PORTION + 1), st.integers(0, 2**32))
@examples(24, 2000)
def test_rows_are_written_and_read_like_an_array(count: int, seed: int) -> None:
    """All of them or some, by slices, lists and masks, whole portions of designs or any."""
    random = np.random.default_rng(seed)
    expected, found = np.zeros((5, count)), Rows(5, count)
    found[:] = expected
    ends = np.sort(random.integers(0, count + 1, 2))
    whole = np.sort(random.integers(0, count // PORTION + 1, 2)) * PORTION
    designs = [
        slice(None),
        slice(*ends),
        slice(*whole),
        slice(whole[0], None),
        slice(0, None, 2),
        random.permutation(count)[: ends[0]],
        random.random(count) < 0.3,
    ]
    for rows in (slice(1, 4), np.array([3, 0, 1])):
        for some in designs:
            values = random.random((3, expected[:, some].shape[1]))
            found[rows, some] = values
            expected[np.ix_(np.arange(5)[rows], np.arange(count)[some])] = values
            np.testing.assert_array_equal(found[:], expected)
            np.testing.assert_array_equal(found[rows, some], expected[rows][:, some])
        found[rows], expected[rows] = (column := random.random((3, 1))), column
        np.testing.assert_array_equal(found[rows], expected[rows])


@given(mechanisms.fresh())
@examples(10, 600)
def test_blocks_are_the_matrices_of_the_lumped_model(mechanism: Mechanism) -> None:
    check_matrices(mechanism)


@given(st.one_of(mechanisms.fresh(), rosettes.fresh(), actuated_platforms.fresh()))
@examples(6, 400)
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


ALL_OF_A_PART = (
    *("materials.steel.young", "materials.steel.density", "parts.neck.thickness", "parts.neck.profile.length"),
    *(
        "parts.neck.width",
        "parts.foot_notch.thickness",
        "parts.pole_neck.thickness",
        "parts.pole_neck.profile.radius",
        "B2/front.thickness",
    ),
)


def told_and_stepped(stage: Mechanism, names: tuple[str, ...]) -> None:
    """The same derivatives where each number is stepped: a drawn family does not know which number is what."""
    family_plan = plan(stage, names)
    own, values = family_plan.family, designs(family_plan, 3, 0.2)
    if own.topology.locked:
        return

    def draw(numbers: tuple[np.ndarray, ...]) -> Mechanism:
        result = own.mechanism
        for name, number in zip(names, numbers, strict=True):
            result = set_value(result, name, number)
        return result

    stepped, found = slopes_of(drawn_family(draw, names, own.nominal), values), slopes_of(own, values)
    numbers = np.abs(numbers_of(own, values))
    known, others = (dict(each_change(slopes)) for slopes in (found, stepped))
    assert known.keys() <= others.keys()
    for (variable, place, row), other in others.items():
        rate = known.get((variable, place, row), np.zeros(len(values)))  # units tell that what is left out is nought
        if place.kind in {"stiffness", "mass"}:
            diagonal = numbers[place.slots].reshape(*place.shape, -1)[range(place.shape[0]), range(place.shape[0])]
            scale = np.sqrt(diagonal[row // place.shape[0]] * diagonal[row % place.shape[0]])
            assert np.all(np.abs(rate - other) * values[:, variable] <= 1e-13 * scale)
        else:
            assert (variable, place, row) in known


def each_change(slopes: Slopes) -> Iterator[tuple[tuple[int, Feature, int], np.ndarray]]:
    """The derivatives of designs by variable, feature and number of it."""
    keys = ((change.variable, change.place, int(row)) for change in slopes.changes for row in change.rows)
    yield from zip(keys, slopes.values[:], strict=True)


def test_units_of_time_tell_a_stiffness_by_mass_and_frequency() -> None:
    """k = m (2 pi f)^2 grows once with the mass and twice with the frequency; no part of the package has its stiffness so."""
    felt = [(("part", "mass"), (Fraction(1), Fraction(0), Fraction(0))), (("part", "resonance"), (Fraction(0), Fraction(0), Fraction(-1)))]
    told = _told(felt, {path: number for number, (path, _) in enumerate(felt)}, (0, 1))
    assert [(item.variable, item.powers("stiffness", np.array([0])).tolist(), item.rest) for item in told] == [
        (0, [1.0], ()),
        (1, [2.0], ()),
    ]


@given(mechanisms.fresh())
@examples(5, 200)
def test_what_units_tell_is_what_steps_tell(mechanism: Mechanism) -> None:
    told_and_stepped(mechanism, varied(mechanism))


def test_units_tell_modulus_density_and_one_length_of_every_part() -> None:
    told = plan(double_triangle(), ALL_OF_A_PART).family.told
    assert {ALL_OF_A_PART[item.variable] for item in told["mass", 0]} == {*ALL_OF_A_PART[:2], "parts.neck.profile.length"}
    assert len(told["mass", 3]) == 2  # the notch's other lengths do not vary
    told_and_stepped(double_triangle(), ALL_OF_A_PART)


@given(rosettes.fresh())
@examples(8, 200)
def test_iteration_agrees_with_dense_matrices_in_numpy_and_in_c(mechanism: Mechanism) -> None:
    """Rosettes have repeated modes; whatever is proved must be right."""
    family_plan = plan(mechanism, varied(mechanism))
    if family_plan.start is None or family_plan.family.topology.locked:
        return
    stage = stage_of(family_plan, designs(family_plan, 4, 0.1))
    for method in METHODS:
        found = iterate(family_plan, stage, method)
        for design in np.flatnonzero(found.good):
            exact = wholly(stage.take(np.array([design])), family_plan.choice)[0]
            np.testing.assert_allclose(found.values[design], exact.values[0], rtol=2e-6)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("names", [SHARED, SHARED + SINGLE])
def test_frequencies_and_gradients_of_the_shipped_stage(names: tuple[str, ...], method: Method) -> None:
    """Shared numbers keep the symmetry, and so the pairs; single ones split them."""
    family_plan = plan(double_triangle(), names)
    values = designs(family_plan, 5, 0.08)
    found = platform_modes(family_plan, values, slopes=True, method=method)
    assert (found.status == Status.ITERATED).all()
    for design in (0, 3):
        stage = one(family_plan, values[design])
        exact = fs.sensitivities(stage, names, modes=6)
        np.testing.assert_allclose(found.frequencies[design], exact.frequencies, rtol=1e-6)
        scale = values[design][:, None] / exact.frequencies
        assert np.max(np.abs(found.gradient[design] - exact.frequency) * scale) < 1e-6
        for group, slopes in zip(exact.clusters, exact.one_sided, strict=True):
            mine = np.linalg.eigvalsh(found.slopes[design][:, group][..., group])
            assert np.max(np.abs(mine - slopes) * scale[:, :1]) < 1e-6


def test_overlaps_that_begin_away_from_the_nominal_design_have_their_derivatives() -> None:
    """A taller pole's side reaches into its top: then its width moves the pole's centre up and down, too."""
    names = ("units.vertical.bodies.pole.solids.left.at.y", "units.vertical.bodies.pole.solids.left.size.z")
    family_plan = plan(double_triangle(), names)
    values = family_plan.family.nominal * np.array([[1.01, 0.99], [1.01, 1.01]])
    assert slopes_of(family_plan.family, values).missed.tolist() == [False, True]
    found = platform_modes(family_plan, values, slopes=True)
    for design in range(2):
        exact = fs.sensitivities(one(family_plan, values[design]), names, modes=6)
        assert np.max(np.abs(found.gradient[design] - exact.frequency) * values[design][:, None] / exact.frequencies) < 1e-6


@pytest.mark.parametrize("slopes", [False, True])
def test_the_kernel_is_numpy(slopes: bool) -> None:
    if kernel() is None:
        pytest.skip("no compiler")
    family_plan = plan(double_triangle(), SHARED + SINGLE)
    values = designs(family_plan, 37, 0.05)
    fast, plain = (platform_modes(family_plan, values, slopes=slopes, method=method) for method in METHODS)
    np.testing.assert_array_equal(fast.status, plain.status)
    np.testing.assert_allclose(fast.frequencies, plain.frequencies, rtol=1e-9)  # numpy's are that exact
    np.testing.assert_allclose(fast.share, plain.share, rtol=1e-4)  # and their shares: 4e-6 without derivatives
    whole = wholly(Stage(family_plan.scheme, numbers_of(family_plan.family, values[:9])), family_plan.choice)
    known = np.sqrt([each.values[0, :6] for each in whole]) / (2.0 * np.pi)
    np.testing.assert_allclose(fast.frequencies[:9], known, rtol=1e-12)  # single modes are found closer than they must be
    alone = fs.modes(fs.lumped(one(family_plan, values[7])))
    np.testing.assert_allclose(fast.share[7], np.asarray(alone.share)[list(alone.platform)], rtol=1e-9)
    if slopes:
        largest = np.max(np.abs(plain.gradient), axis=(0, 2))[:, None]
        assert np.max(np.abs(fast.gradient - plain.gradient) / largest) < 1e-6  # the bound of the vectors' angles
        exact = fs.sensitivities(one(family_plan, values[7]), family_plan.family.addresses, modes=6)
        assert np.max(np.abs(fast.gradient[7] - exact.frequency) / largest) < 1e-9


def test_the_kernel_gives_back_all_the_memory_that_it_takes() -> None:
    """Where its table of links stayed, the calls would keep seven times as much."""
    if (library := kernel()) is None:
        pytest.skip("no compiler of C")
    family_plan = plan(double_triangle(), ())
    assert family_plan.start is not None
    stage = Stage(family_plan.scheme, numbers_of(family_plan.family, np.zeros((1, 0))))
    tables = Tables(family_plan.scheme, (), family_plan.planes)
    taken: list[int] = []
    for _ in range(3):  # the first calls settle what stays with the process
        for _ in range(700):
            by_kernel(library, stage, family_plan.start, tables)
        taken.append(psutil.Process().memory_info().rss)
    assert taken[-1] - taken[0] < 8e6


@pytest.mark.parametrize("method", METHODS)
def test_results_do_not_depend_on_how_the_batch_is_cut(method: Method) -> None:
    family_plan = plan(double_triangle(), SHARED + SINGLE)
    values = designs(family_plan, 19, 0.2)
    whole = platform_modes(family_plan, values, slopes=True, method=method)
    for cut in ((0, 1), (1, 12), (12, 19)):
        piece = platform_modes(family_plan, values[slice(*cut)], slopes=True, method=method)
        np.testing.assert_array_equal(piece.frequencies, whole.frequencies[slice(*cut)])
        np.testing.assert_array_equal(piece.slopes, whole.slopes[slice(*cut)])
    backwards = platform_modes(family_plan, values[::-1], slopes=True, method=method)
    np.testing.assert_array_equal(backwards.frequencies[::-1], whole.frequencies)
    np.testing.assert_array_equal(backwards.gradient[::-1], whole.gradient)


def test_fitted_features_give_what_each_design_gives() -> None:
    """Over stated ranges features are polynomials; outside them, and without them, each design is described by itself.

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
    for slopes in (False, True):
        near, exact = (platform_modes(each, values, slopes=slopes) for each in (fitted, plain))
        np.testing.assert_allclose(near.frequencies, exact.frequencies, rtol=1e-8)
        scale = np.abs(values)[:, : near.gradient.shape[1], None] / exact.frequencies[:, None, :]
        assert np.max(np.abs(near.gradient - exact.gradient) * scale, initial=0.0) < 1e-6
        np.testing.assert_array_equal(near.frequencies[7], exact.frequencies[7])
        cut = platform_modes(fitted, values[5:23], slopes=slopes)
        np.testing.assert_array_equal(cut.frequencies, near.frequencies[5:23])
        np.testing.assert_array_equal(cut.slopes, near.slopes[5:23])


def test_what_is_not_smooth_over_a_range_is_not_fitted() -> None:
    nominal = plan(double_triangle(), ("parts.neck.thickness",)).family.nominal
    assert plan(double_triangle(), ("parts.neck.thickness",), ranges=(0.02 * nominal, 40.0 * nominal)).surface is None


def test_the_batch_is_the_loop() -> None:
    """The dense path: a stage of few bodies, all designs at once against one at a time."""
    case = CASES["parallelogram"].build()
    family_plan = plan(case, varied(case))
    values = designs(family_plan, 9, 0.1)
    whole = platform_modes(replace(family_plan, start=None), values, slopes=True)
    assert (whole.status == Status.WHOLE).all()
    for number, value in enumerate(values):
        alone = fs.modes(lumped(one(family_plan, value)))
        np.testing.assert_allclose(whole.frequencies[number], alone.platform_frequencies, rtol=1e-12)


def test_designs_that_fail_stop_no_other() -> None:
    family_plan = plan(double_triangle(), ("parts.neck.thickness", "parts.stack_vertical.stiffness"))
    good = family_plan.family.nominal
    values = np.array([good, good * [np.nan, 1.0], good * [1.0, 0.0], good * [1.0, -1.0], good * [np.inf, 1.0], good * [1e-4, 1.0]])
    for method in METHODS:
        found = platform_modes(family_plan, values, slopes=True, method=method)
        names = [Status(status).name for status in found.status]
        assert names[:2] == ["ITERATED", "NOT_FINITE"]
        assert names[3] == "SINGULAR"
        assert names[4] == "NOT_FINITE"
        assert np.isnan(found.frequencies[1:5]).all()
        np.testing.assert_allclose(found.frequencies[0], fs.modes(lumped(double_triangle())).platform_frequencies, rtol=1e-6)
    assert platform_modes(family_plan, values[:0], slopes=True).slopes.shape == (0, 2, 6, 6)


def test_designs_that_cannot_be_weighed_stop_no_other() -> None:
    """A side of another metal touches a pole's top: some designs near the nominal one reach into it, and who fills it nobody knows."""
    metals = set_value(double_triangle(), "units.vertical.bodies.pole.solids.left.material", "light")
    metals = replace(metals, materials={**metals.materials, "light": replace(metals.materials["steel"], density=2700.0)})
    names = ("units.vertical.bodies.pole.solids.left.at.y", "units.vertical.bodies.pole.solids.left.size.z")
    family_plan = plan(metals, names)
    values = family_plan.family.nominal * np.array([[1.0, 1.0], [1.01, 1.01], [1.01, 0.99], [1.0, 1.02]])
    found = platform_modes(family_plan, values, slopes=True)
    assert [Status(status).name for status in found.status] == ["ITERATED", "REFUSED", "ITERATED", "REFUSED"]
    assert np.isnan(found.frequencies[[1, 3]]).all()
    for design in (0, 2):
        alone = fs.modes(lumped(one(family_plan, values[design]))).platform_frequencies
        np.testing.assert_allclose(found.frequencies[design], alone, rtol=1e-6)
    exact = fs.sensitivities(one(family_plan, values[2]), names, modes=6)
    assert np.max(np.abs(found.gradient[2] - exact.frequency) * values[2][:, None] / exact.frequencies) < 1e-6


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
    for method in METHODS:
        found = platform_modes(family_plan, values, method=method)
        for row, value in zip(found.frequencies, values, strict=True):
            np.testing.assert_allclose(row, fs.modes(lumped(one(family_plan, value))).platform_frequencies, rtol=1e-6)


def test_without_a_compiler_the_results_are_the_same(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    family_plan = plan(double_triangle(), SHARED)
    values = designs(family_plan, 9, 0.05)
    before = platform_modes(family_plan, values)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / "none"))
    kernel.cache_clear()
    try:
        assert kernel() is None
        after = platform_modes(family_plan, values)
    finally:
        kernel.cache_clear()
    np.testing.assert_allclose(after.frequencies, before.frequencies, rtol=1e-9)
    np.testing.assert_array_equal(after.status, before.status)


@pytest.mark.parametrize("script", ["exit 1", "echo broken > /dev/null", "exec sleep 0"])
def test_a_compiler_that_builds_nothing_is_none(script: str, monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    compiler = tmp_path / "cc"
    compiler.write_text(f"#!/bin/sh\n{script}\n")
    compiler.chmod(0o755)
    monkeypatch.setenv("CC", str(compiler))
    monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / "cache"))
    kernel.cache_clear()
    try:
        assert kernel() is None
    finally:
        kernel.cache_clear()


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
    stage = ring(massless)
    family_plan = plan(stage, ("bodies.platform.mass", "parts.joint.compliance.x.x", "bodies.platform.inertia.xx"))
    assert len(family_plan.scheme.graph.edges) > len([pair for pair in family_plan.family.topology.links if -1 not in pair]) - 1
    values = designs(family_plan, 6, 0.1)
    for method in METHODS:
        found = platform_modes(family_plan, values, slopes=True, method=method)
        for number in (0, 5):
            design = one(family_plan, values[number])
            alone = fs.modes(lumped(design))
            np.testing.assert_allclose(found.frequencies[number], alone.platform_frequencies, rtol=1e-6)
            exact = fs.sensitivities(design, family_plan.family.addresses, modes=max(alone.platform) + 1)
            expected = exact.frequency[:, list(alone.platform)]
            scale = values[number][:, None] / alone.platform_frequencies
            assert np.max(np.abs(found.gradient[number] - expected) * scale) < 1e-6


def test_iteration_on_a_ring_is_proved() -> None:
    """Not by the dense path alone: the elimination fills in, and the block is still found."""
    family_plan = plan(ring(massless=False), ("bodies.platform.mass",))
    values = designs(family_plan, 4, 0.05)
    assert family_plan.start is not None
    stage = stage_of(family_plan, values)
    for method in METHODS:
        found = iterate(family_plan, stage, method)
        assert found.good.all()
        exact = np.concatenate([each.values for each in wholly(stage, family_plan.choice)])
        np.testing.assert_allclose(found.values, exact, rtol=1e-9)


def test_a_start_without_the_right_modes_is_found_out() -> None:
    """A block that holds nothing of one mode converges to others: counting the pivots' signs tells, and the dense path takes over."""
    family_plan = plan(double_triangle(), ("parts.neck.thickness",))
    assert family_plan.start is not None
    block, force = family_plan.start.block.copy(), family_plan.start.force.copy()
    for each in (block, force):
        each[..., 3] = each[..., 0] + each[..., -1]  # z: alone of its symmetry among the first
    blind = replace(family_plan, start=replace(family_plan.start, block=block, force=force, rounds=1), wider=None)
    value = family_plan.family.nominal[None]
    stage = Stage(blind.scheme, numbers_of(blind.family, value))
    for method in METHODS:
        assert not iterate(blind, stage, method).good.any()
        found = platform_modes(blind, value, method=method)
        assert Status(found.status[0]) is Status.WHOLE
        np.testing.assert_allclose(found.frequencies[0], fs.modes(lumped(double_triangle())).platform_frequencies, rtol=1e-9)


def test_legs_that_are_symmetric_about_a_plane_are_solved_in_two_halves() -> None:
    """Legs with a pivot beside their plane are whole, as are designs without the plane."""
    names = ("parts.neck.thickness", "placements.B4-B6.pattern.turn", "units.vertical.links.pivot.at.y")
    flat = plan(double_triangle(), names)
    tilted = plan(set_value(double_triangle(), names[2], 1e-3), names)
    platform = len(flat.scheme.graph.order) - 1
    assert [(each.planes.through[:platform] >= 0).sum() for each in (flat, tilted)] == [platform, 6]
    assert [each.planes.copies[platform + 1 :].tolist() for each in (flat, tilted)] == [[3, 3], [3]]
    if kernel() is None:
        pytest.skip("no compiler")
    numbers = designs(tilted, 9, 0.05)
    numbers[::2, 2] = 0.0
    for family_plan in (flat, tilted):
        stage = stage_of(family_plan, numbers)
        found, known = iterate(family_plan, stage), wholly(stage, family_plan.choice)
        assert found.good.all()
        np.testing.assert_allclose(found.values, np.concatenate([each.values for each in known]), rtol=1e-12)
        scale = np.max(np.abs(found.slopes), axis=(0, 2))[:, None]
        assert np.max(np.abs(found.slopes - np.concatenate([each.slopes for each in known])) / scale) < 1e-9


@pytest.mark.parametrize("method", METHODS)
def test_derivatives_do_not_depend_on_how_bodies_are_seen(method: Method) -> None:
    """A unit that turns changes nothing in axes that turn with it but where it joins the platform."""
    steps = {"B2.shift.x": 1e-4, "B2.rotation.z": 2e-3, "B5.rotation.x": -3e-3, "B5.rotation.y": 1e-3}
    stage = double_triangle()
    for name, step in steps.items():
        stage = set_value(stage, name, step)
    names = (*steps, "placements.B4-B6.pattern.turn", "materials.steel.density")
    turning = plan(stage, names)
    still = replace(turning, family=replace(turning.family, standpoint=replace(turning.family.standpoint, turning=False)))
    rows = [len(slopes_of(each.family, each.family.nominal[None]).values) for each in (turning, still)]
    assert rows[0] < 0.6 * rows[1]
    values = designs(turning, 4, 0.2)
    found, known = (platform_modes(each, values, slopes=True, method=method).gradient for each in (turning, still))
    exact = fs.sensitivities(one(turning, values[2]), names, modes=6)
    scale = np.max(np.abs(exact.frequency), axis=1)[:, None]
    assert np.max(np.abs(found - known) / scale) < 1e-6
    assert np.max(np.abs(found[2] - exact.frequency) / scale) < 1e-6


def test_what_turns_may_change_too() -> None:
    """One number that turns a copy, makes a body of it longer and moves a hinge does what three do; fitted over a range, too."""
    stage = double_triangle()
    lever = "units.vertical.bodies.lever.solids.head.size.x"
    names = ("B4.rotation.z", lever, "units.vertical.links.pivot.at.z")
    sizes = np.array([1.0, get(stage, lever), 0.01])
    start = np.array([0.0, get(stage, lever), get(stage, names[2])])

    def draw(values: tuple[np.ndarray, ...]) -> Mechanism:
        drawn = stage
        for name, size, own in zip(names, sizes, start, strict=True):
            drawn = set_value(drawn, name, own + size * values[0])
        return drawn

    one_number = drawn_family(draw, ("turn",), np.array([0.02]))
    values = np.array([[0.02], [0.021]])
    apart = platform_modes(plan(draw((np.array(0.02),)), names), start + sizes * values, slopes=True)
    known = np.einsum("bpk,p->bk", apart.gradient, sizes)
    ranges = (np.array([0.015]), np.array([0.025]))
    plans = [plan_family(one_number), plan_family(one_number, ranges=ranges)]
    assert plans[1].surface is not None
    for family_plan in plans:
        found = platform_modes(family_plan, values, slopes=True).gradient[:, 0]
        assert np.max(np.abs(found - known)) < 1e-6 * np.max(np.abs(known))


def test_a_plan_that_was_used_serves_in_another_process() -> None:
    """Places in memory are not handed on."""
    family_plan = plan(double_triangle(), SHARED)
    values = designs(family_plan, 3, 0.05)
    known = platform_modes(family_plan, values, slopes=True)
    handed = pickle.loads(pickle.dumps(family_plan))  # noqa: S301 - our own
    assert all("places" not in vars(tables) for tables in (handed.tables, handed.slope_tables))
    np.testing.assert_array_equal(platform_modes(handed, values, slopes=True).gradient, known.gradient)


@pytest.mark.skipif("kernel() is None", reason="no compiler")
def test_legs_are_equal_wherever_on_the_platform_they_end() -> None:
    """Feet reach into a thicker plate, not all as far: its reference point moves. In a longer one no two modes are alike."""
    stage, sizes = double_triangle(), {"x": 1.3, "z": 1.05}
    for axis, more in sizes.items():
        name = f"bodies.platform.solids.plate.size.{axis}"
        stage = set_value(stage, name, more * get(stage, name))
    family_plan = plan(stage, ("parts.neck.thickness", "bodies.platform.solids.plate.size.z"))
    assert family_plan.planes.copies[-2:].tolist() == [3, 3]
    read = stage_of(family_plan, designs(family_plan, 9, 0.02))
    found, known = iterate(family_plan, read), wholly(read, family_plan.choice)
    assert found.good.all()
    assert "whole" not in vars(family_plan.slope_tables)  # none had to be solved in the stage's axes
    np.testing.assert_allclose(found.values, np.concatenate([each.values for each in known]), rtol=1e-12)
    scale = np.max(np.abs(found.slopes), axis=(0, 2))[:, None]
    assert np.max(np.abs(found.slopes - np.concatenate([each.slopes for each in known])) / scale) < 1e-9


def test_links_at_the_points_of_their_bodies_have_no_arms() -> None:
    """Nothing is divided by the longest arm where it is nought."""
    parts = {"spring": ComplianceMatrix(tuple(map(tuple, np.diag([1e-6, 1e-6, 1e-6, 1e-3, 1e-3, 1e-3]).tolist())), free=(), mass=0.0)}
    body = Body(mass=1.0, centre=(0.0, 0.0, 0.0), inertia=Inertia(xx=1e-3, yy=1e-3, zz=1e-3))
    stage = Mechanism("point", parts=parts, bodies={PLATFORM: body}, links={"one": Link((GROUND, PLATFORM), "spring", (0.0, 0.0, 0.0), X)})
    found = platform_modes(plan(stage, ()), np.zeros((1, 0)))
    np.testing.assert_allclose(found.frequencies[0], np.sqrt(1e6) / (2.0 * np.pi), rtol=1e-12)


@pytest.mark.skipif("kernel() is None", reason="no compiler")
@pytest.mark.parametrize("kind", ["first", "turn", "inertia"])
def test_legs_that_are_equal_near_the_nominal_design_need_not_be_so_elsewhere(kind: str) -> None:
    """Arms, axes and bodies of B3 are those of B1, whose matrices serve for both, but in every other design."""
    family_plan = plan(double_triangle(), ("parts.neck.thickness",))
    assert set(family_plan.planes.copies.tolist()) == {1, 3}
    stage = stage_of(family_plan, designs(family_plan, 9, 0.05))
    names = list(expand(double_triangle()).links)
    owner = stage.scheme.topology.bodies.index("B3/tip") if kind == "inertia" else names.index("B3/front")
    place = next(place for place in stage.scheme.topology.features if (place.kind, place.owner) == (kind, owner))
    odd = stage.numbers[place.slots, 1::2]
    if kind == "turn":
        odd[:] = np.roll(odd.reshape(3, 3, -1), 1, axis=1).reshape(9, -1)  # the hinge turned by a third about its diagonal
    else:
        odd[:] *= 1.01  # an arm in the leg's plane, a body that is heavier
    found, known = iterate(family_plan, stage), wholly(stage, family_plan.choice)
    assert found.good.all()
    np.testing.assert_allclose(found.values, np.concatenate([each.values for each in known]), rtol=1e-12)
    scale = np.max(np.abs(found.slopes), axis=(0, 2))[:, None]
    assert np.max(np.abs(found.slopes - np.concatenate([each.slopes for each in known])) / scale) < 1e-9


@pytest.mark.parametrize("method", METHODS)
def test_one_end_of_a_mirrored_mass_tells_what_both_tell(method: Method) -> None:
    family_plan = plan(double_triangle(), SHARED + SINGLE)
    values = designs(family_plan, 9, 0.05)
    assert len(family_plan.family.mirrored) == family_plan.family.topology.parts
    stages = [Stage(family_plan.scheme, *numbered(family_plan.family, values, wide=wide)) for wide in (False, True)]
    assert len(stages[0].slopes.values) < len(stages[1].slopes.values)  # type: ignore[union-attr]
    one, both = (iterate(family_plan, stage, method) for stage in stages)
    scale = np.max(np.abs(both.slopes), axis=(0, 2))[:, None]
    np.testing.assert_allclose(one.slopes / scale, both.slopes / scale, rtol=0.0, atol=1e-12)


def numbered(family: Family, values: np.ndarray, *, wide: bool) -> tuple[np.ndarray, int, Slopes]:
    numbers, slopes = numbers_and_slopes(family, values, wide=wide)
    return numbers, values.shape[1], slopes


def test_a_mass_that_is_not_mirrored_in_a_design_is_missed_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """Such designs are solved again with both ends."""
    family_plan = plan(double_triangle(), ("parts.neck.thickness",))
    values = designs(family_plan, 4, 0.05)
    whole = platform_modes(family_plan, values, slopes=True)
    monkeypatch.setattr("flexstage.models.batch.parameters.numbers.is_mirrored", lambda numbers, _: np.arange(numbers.shape[1]) % 2 == 0)
    assert slopes_of(family_plan.family, values).missed.tolist() == [False, True, False, True]
    np.testing.assert_allclose(platform_modes(family_plan, values, slopes=True).gradient, whole.gradient, rtol=1e-9)


@given(st.integers(2, 9).flatmap(lambda count: st.tuples(st.just(count), st.sets(st.tuples(st.integers(0, 8), st.integers(0, 8))))))
@examples(30, 1000)
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
    for start, stop in found.levels:
        assert not any(start <= first and later < stop for first, later in found.edges)


def test_what_stays_free_is_refused_by_name() -> None:
    stage = ring(massless=False)
    loose = replace(stage, links={name: link for name, link in stage.links.items() if GROUND not in link.joins})
    with pytest.raises(DesignError, match="stiffness matrix is singular"):
        plan(loose, ("bodies.platform.mass",))
    with pytest.raises(DesignError, match="nearest"):
        plan(stage, ("bodies.platform.masss",))


def test_expansion_is_the_same_for_all() -> None:
    """Overrides of single copies make parts of their own: as many as the description has."""
    names = ("parts.neck.thickness", "B2/front.thickness")
    assert plan(double_triangle(), names).family.topology.parts == 7
    assert len(expand(double_triangle()).links) == 27


def test_by_iteration_gives_no_slopes_unless_asked() -> None:
    family_plan = plan(double_triangle(), ("parts.neck.thickness",))
    stage = Stage(family_plan.scheme, numbers_of(family_plan.family, family_plan.family.nominal[None]))
    assert family_plan.start is not None
    assert by_iteration(stage, family_plan.start).matrices.shape == (1, 0, 6, 6)
