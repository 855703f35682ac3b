"""Laws of platform frequencies: no unit, reference point, basis of repeated modes or small local mass decides them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.assessment.judge import judge
from flexstage.analysis.dynamics.modes import Modes, modes
from flexstage.base.number import Array
from flexstage.cases.registry import CASES
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.batch.choice import THRESHOLD, Choice, choose, compliance_root, participation, platform_rows
from flexstage.models.linear.model import Contribution, LinearModel
from flexstage.models.lumped import Masses
from flexstage.models.lumped import lumped as fresh_lumped
from flexstage.show.tables.modes import listed_modes
from flexstage.spatial.frame import cross_matrix
from flexstage.studies.optimisation.search.spectrum import Modes as Wanted
from flexstage.studies.optimisation.search.spectrum import spectra
from tests.conftest import examples
from tests.laws.shared import lumped
from tests.laws.strategies import actuated_platforms, rosettes

STAGES = st.one_of(actuated_platforms(), rosettes())
TENTH = 0.1
"""The share of the compliance that is defined to count."""
DOUBTFUL = 1e-6
"""How near to it rounding decides."""


def defined(model: LinearModel) -> tuple[Array, bool]:
    """Platform frequencies [Hz] word by word from the definition, with roots of C; and whether no eigenvalue is near the threshold."""
    stiffness, inertia = model.stiffness_matrix, model.inertia_matrix
    rows = platform_rows(model)
    inverse_values, shapes = scipy.linalg.eigh(inertia, stiffness)
    kept = inverse_values > 1e-13 * inverse_values[-1]
    omega = np.sqrt(1.0 / inverse_values[kept])
    seen = rows @ shapes[:, kept]  # of unit stiffness: phi / omega
    half = scipy.linalg.fractional_matrix_power(rows @ np.linalg.inv(stiffness) @ rows.T, -0.5).real
    found, near = list[float](), False
    for frequency in np.sort(omega):
        up_to = half @ seen[:, omega <= frequency * (1.0 + 1e-9)]
        own = np.linalg.eigvalsh(up_to @ up_to.T)
        near |= len(found) < 6 and bool(np.any(np.abs(own - TENTH) < DOUBTFUL))
        found += [frequency / (2.0 * np.pi)] * (int(np.sum(own > TENTH)) - len(found))
    return np.array(found), near


def with_rows(model: LinearModel, change: Array) -> LinearModel:
    """The platform's twist multiplied by a matrix (6, 6)."""
    index = model.output_index(tuple(f"{PLATFORM}.{name}" for name in ("x", "y", "z", "rx", "ry", "rz")))
    output = model.output.copy()
    output[index] = change @ output[index]
    return replace(model, output=output)


def same(one: Modes, other: Modes, scale: float = 1.0) -> None:
    np.testing.assert_allclose(one.platform_frequencies, scale * other.platform_frequencies, rtol=2e-6)
    assert one.platform == other.platform


@given(STAGES)
@examples(6)
def test_platform_frequencies_are_those_of_the_definition(stage: Mechanism) -> None:
    expected, near = defined(lumped(stage))
    if not near:
        np.testing.assert_allclose(modes(lumped(stage)).platform_frequencies, expected, rtol=2e-6)


@given(STAGES, st.tuples(*3 * [st.floats(-2.0, 2.0)]))
@examples(7)
def test_units_decide_nothing(stage: Mechanism, powers: tuple[float, float, float]) -> None:
    """Other units of length, mass and time: frequencies are the same times the unit of time."""
    length, mass, time = 10.0 ** np.array(powers)
    model = lumped(stage)
    other = replace(
        with_rows(model, np.diag([*3 * [1.0 / length], 1.0, 1.0, 1.0])),
        stiffness={name: replace(item, law=item.law * length**2 * mass / time**2) for name, item in model.stiffness.items()},
        inertia={name: replace(item, law=item.law * length**2 * mass) for name, item in model.inertia.items()},
    )
    same(modes(other), modes(model), 1.0 / time)


@given(STAGES, st.tuples(*3 * [st.floats(-3.0, 3.0)]))
@examples(7)
def test_the_reference_point_and_axes_decide_nothing(stage: Mechanism, arm: tuple[float, float, float]) -> None:
    model = lumped(stage)
    carry = np.eye(6)
    carry[:3, 3:] = -cross_matrix(np.array(arm))
    turn = scipy.spatial.transform.Rotation.from_rotvec(arm).as_matrix()
    same(modes(with_rows(model, np.kron(np.eye(2), turn) @ carry)), modes(model))


@given(rosettes(), st.integers(0, 2**32 - 1))
@examples(7)
def test_the_basis_of_repeated_modes_decides_nothing(stage: Mechanism, seed: int) -> None:
    """Any rotation within clusters, and any rounding that sets repeated modes apart: the same frequencies."""
    model = lumped(stage)
    found = modes(model)
    values = (2.0 * np.pi * found.frequencies) ** 2
    parts = participation(compliance_root(model, platform_rows(model)), found.platform_shapes, values)
    random = np.random.default_rng(seed)
    for group in np.split(np.arange(len(values)), np.flatnonzero(np.diff(values) > 1e-7 * values[1:]) + 1):
        parts[:, group] = parts[:, group] @ np.linalg.qr(random.normal(size=(len(group), len(group))))[0]
        values[group] = np.sort(values[group] * (1.0 + 1e-9 * random.uniform(size=len(group))))
    mask = choose(values[None], parts[None], Choice()).mask[0]
    np.testing.assert_allclose(np.sqrt(values[mask]) / (2.0 * np.pi), found.platform_frequencies, rtol=2e-6)


def with_local(model: LinearModel, share: float, rate: float) -> LinearModel:
    """A local mass on the platform: `share` of its inertia, on springs on which alone it has the circular frequency `rate`."""
    size = len(model.coordinates)
    inertia = model.inertia[PLATFORM]
    wide = {
        kind: {
            name: replace(item, operator=np.concatenate([item.operator, np.zeros((len(item.operator), 6))], axis=1))
            for name, item in getattr(model, kind).items()
        }
        for kind in ("stiffness", "inertia")
    }
    own = np.concatenate([np.zeros((6, size)), np.eye(6)], axis=1)
    law = share * inertia.law
    wide["stiffness"]["local"] = Contribution(own - wide["inertia"][PLATFORM].operator, rate**2 * law)
    wide["inertia"]["local"] = Contribution(own, law)
    return replace(
        model,
        **wide,
        coordinates=(*model.coordinates, *(f"local.{number}" for number in range(6))),
        output=np.concatenate([model.output, np.zeros((len(model.output), 6))], axis=1),
    )


@given(STAGES, st.integers(0, 5), st.floats(0.5, 2.0))
@examples(8)
def test_a_local_mass_of_a_thousandth_changes_platform_frequencies_by_less_than_five_per_cent(
    stage: Mechanism, number: int, ratio: float
) -> None:
    """From 0.96 times a platform frequency on, it may be counted for it; below, it has too little compliance.

    Without the local mass, no eigenvalue may be near the threshold: there it decides.
    """
    model = lumped(stage)
    plain = modes(model)
    values = (2.0 * np.pi * plain.frequencies) ** 2
    parts = participation(compliance_root(model, platform_rows(model)), plain.platform_shapes, values)
    own = np.linalg.eigvalsh(np.cumsum(np.moveaxis(parts[:, None] * parts[None], -1, 0), axis=0))[: plain.platform[-1] + 1]
    if np.any(np.abs(own - TENTH) < 0.03):
        return
    rate = 2.0 * np.pi * ratio * plain.platform_frequencies[number]
    heavier = modes(with_local(model, 1e-3, rate)).platform_frequencies
    np.testing.assert_allclose(heavier, plain.platform_frequencies, rtol=0.05)


def chains(inner: float, soft: float) -> LinearModel:
    """In each of six freedoms the ground, a spring 1, a mass `inner`, a spring 1 / `soft` and a platform of mass 1: two-mass chains."""
    size = np.arange(1.0, 7.0)  # freedoms apart
    first, second = np.eye(6, 12), np.eye(6, 12, 6)
    return LinearModel(
        coordinates=tuple(f"q{number}" for number in range(12)),
        stiffness={"ground": Contribution(second, np.diag(size)), "upper": Contribution(first - second, np.diag(size / soft))},
        inertia={PLATFORM: Contribution(first, np.eye(6)), "inner": Contribution(second, inner * np.eye(6))},
        inputs=(),
        force=np.zeros((12, 0)),
        imposed={},
        outputs=lumped(CASES["parallelogram"].build()).outputs[:6],
        output=first,
        feedthrough=np.zeros((6, 0)),
        rigid=np.zeros((12, 6)),
        rigid_output=np.zeros((6, 6)),
        base_inertia=np.zeros((12, 6)),
        damping=None,
        idle=(),
        provenance="by hand",
    )


@pytest.mark.parametrize("inner", [0.3, 3.0, 30.0, 100.0])
@pytest.mark.parametrize("soft", [0.05, 0.5, 3.0, 10.0, 30.0])
def test_two_mass_chains(inner: float, soft: float) -> None:
    """Eigenvalues of [1, a; a, b] by hand: the lower mode counts where it has more than a tenth of the compliance 1 + soft."""
    # K^-1 M of platform and inner mass: [[1 + s, m], [1, m]]; its eigenvalues mu = 1 / omega^2
    half, determinant = 0.5 * (1.0 + soft + inner), inner * soft
    high, low = half + np.sqrt(half**2 - determinant), half - np.sqrt(half**2 - determinant)
    # mu phi^2 of the platform: (mu, phi) with inner motion v = (mu - 1 - s) / m for u = 1 and phi^2 = 1 / (1 + m v^2)
    share = high / (1.0 + (high - 1.0 - soft) ** 2 / inner) / (1.0 + soft)
    expected = 1.0 / np.sqrt(high if share > TENTH else low)
    found = modes(chains(inner, soft))
    np.testing.assert_allclose(found.platform_frequencies, expected * np.sqrt(np.arange(1.0, 7.0)) / (2.0 * np.pi), rtol=1e-9)
    lower = found.frequencies[:, None] * 2.0 * np.pi / np.sqrt(np.arange(1.0, 7.0) / high)
    np.testing.assert_allclose(found.compliance_share[np.any(np.abs(lower - 1.0) < 1e-9, axis=1)], share, rtol=1e-9)


def test_locked_directions_have_no_platform_frequency() -> None:
    """Rows of rounding, and one direction that two others tell: as many frequencies as the platform has directions that give."""
    model = chains(0.3, 0.5)
    free = modes(model).platform_frequencies
    rounding = 1e-16 * np.random.default_rng(3).normal(size=(3, 6))
    found = modes(with_rows(model, np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]) + np.vstack([np.zeros((3, 6)), rounding])))
    np.testing.assert_allclose(found.platform_frequencies, free[:3], rtol=1e-9)
    twice = np.eye(6)
    twice[5] = twice[3] + twice[4]
    np.testing.assert_allclose(modes(with_rows(model, twice)).platform_frequencies, free[:5], rtol=1e-9)


def test_all_modes_are_listed_where_none_is_the_platforms() -> None:
    found = modes(with_rows(chains(0.3, 0.5), np.zeros((6, 6))))
    assert found.platform == ()
    assert listed_modes(found) == tuple(range(12))


def test_a_soft_support_is_a_platform_frequency_near_zero() -> None:
    """In the limit of no stiffness along x the first frequency is zero and the others are those of the other directions."""
    stage = CASES["hexapod"].build()
    model = lumped(stage)
    plain = modes(model).platform_frequencies
    loose = np.eye(6)[:1] @ model.inertia[PLATFORM].operator
    freed = np.linalg.solve(model.stiffness_matrix, loose.T)
    weaker = 1.0 / (loose @ freed).item()  # taking this much off leaves nothing along x
    for left in (1e-3, 1e-6):
        softened = {**model.stiffness, "less": Contribution(loose, np.array([[-weaker * (1.0 - left)]]))}
        found = modes(replace(model, stiffness=softened)).platform_frequencies
        assert found[0] < 2.0 * np.sqrt(left) * plain[0]
        assert len(found) == 6
        assert found[1] > 0.3 * plain[0]


@given(STAGES)
@examples(5)
def test_optimisation_takes_the_same_modes(stage: Mechanism) -> None:
    (spectrum,) = spectra(lumped(stage), (Wanted(1, platform=True),), (1, 0))[0]
    np.testing.assert_allclose(spectrum.frequencies, modes(lumped(stage)).platform_frequencies, rtol=2e-6)


@pytest.mark.parametrize("name", ["scanner", "bridge"])
def test_no_verdict_depends_on_the_limit_of_listed_modes(name: str) -> None:
    stage = CASES[name].build()
    asked = {f"frequency.platform.{number}": "at least 1 Hz" for number in range(1, 7)} | {"frequency.3": "at least 1 Hz"}
    values = [judge(replace(stage, max_mode_frequency=limit, requirements=asked)) for limit in (None, 10.0, 300.0)]
    first, *others = [[str(each.value) for each in verdicts] for verdicts in values]
    assert others == [first, first]


def test_modes_are_the_platforms_from_a_tenth_of_the_compliance_on() -> None:
    values = np.array([[1.0, 2.0, 2.0, 3.0]])
    for first in (0.99 * THRESHOLD, 1.01 * THRESHOLD):
        parts = np.zeros((1, 2, 4))
        parts[0, 0, 0], parts[0, 0, 1], parts[0, 1, 2] = np.sqrt(first), 0.5, 0.9
        found = choose(values, parts, Choice(count=2))
        assert found.mask[0].tolist() == ([True, False, True, False] if first > THRESHOLD else [False, True, True, False])


def test_a_platform_whose_units_have_no_mass_has_its_six_modes() -> None:
    model = fresh_lumped(CASES["double-triangle"].build(), Masses.PLATFORM)
    assert modes(model).platform == (0, 1, 2, 3, 4, 5)
