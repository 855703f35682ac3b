"""Laws of parts by beam theory, on random hinges, leaves, rods, stacks and given matrices."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.beams.compliance import compliance, law, stiffness
from flexstage.beams.mass import mass
from flexstage.beams.stress import stress
from flexstage.parts.compliance_matrix import ComplianceMatrix, Joint
from flexstage.parts.freedom import ALL, Freedom
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular, Elliptic, Filleted, FreeForm, Hyperbolic, Parabolic, Power, Straight, Vee
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.rod import Rod

sizes = st.floats(0.2, 8.0)


def _vee(flank, radius, angle):
    return Vee(length=2.0 * (flank + radius * np.sin(0.5 * (np.pi - angle))), radius=radius, angle=angle)


def _reinforced(middle, flexure, thickness, step, section, share):
    fillet = None if share is None else share * min(step, flexure)
    length, thick = middle + 2.0 * flexure, thickness + 2.0 * step
    return ReinforcedLeaf("m", length, thickness, 5.0, section, flexure_length=flexure, reinforced_thickness=thick, fillet=fillet)


def _table(rows):
    """Cuts that go up and down, thinnest in the middle."""
    steps, heights = zip(*rows, strict=True)
    return FreeForm((0.0, *np.cumsum(steps).tolist()), (0.0, *heights))


materials = st.builds(Material, young=st.floats(0.5, 4.0), poisson=st.floats(-0.4, 0.49), density=st.floats(0.5, 4.0))
profiles = st.one_of(
    st.builds(Circular, radius=sizes),
    st.builds(Elliptic, along=sizes, across=sizes),
    st.builds(lambda straight, radius: Filleted(straight + 2.0 * radius, radius), sizes, sizes),
    st.builds(Straight, length=sizes),
    st.builds(Parabolic, along=sizes, across=sizes),
    st.builds(Hyperbolic, along=sizes, across=sizes, semi_axis=sizes),
    st.builds(Power, along=sizes, across=sizes, exponent=st.floats(1.0, 12.0)),
    st.builds(_vee, sizes, sizes, st.floats(0.4, 2.8)),
    st.lists(st.tuples(sizes, sizes), min_size=1, max_size=4).map(_table),
)
beams = st.one_of(
    st.builds(Notch, material=st.just("m"), thickness=sizes, width=sizes, profile=profiles),
    st.builds(Neck, material=st.just("m"), thickness=sizes, width=st.none() | sizes, profile=profiles),
    st.builds(Leaf, material=st.just("m"), length=sizes, thickness=sizes, width=sizes, section=st.sampled_from(LeafSection)),
    st.builds(_reinforced, sizes, sizes, sizes, sizes, st.sampled_from(LeafSection), st.none() | st.floats(0.1, 0.9)),
    st.builds(Rod, material=st.just("m"), length=sizes, diameter=sizes),
    st.builds(
        Piezo, stroke=sizes, stiffness=sizes, length=sizes, diameter=sizes, mass=sizes, bending_rigidity=st.none() | sizes,
        poisson=st.floats(0.0, 0.45),
    ),
)  # fmt: skip
subsets = st.lists(st.sampled_from(ALL), unique=True).map(tuple)


@st.composite
def given_parts(draw):
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    factor = random.normal(size=(6, 12))
    matrix = factor @ factor.T / 12.0 + 0.1 * np.eye(6)
    return ComplianceMatrix(tuple(map(tuple, matrix.tolist())), free=(), mass=draw(sizes))


parts = beams | given_parts()


def numbers(value, path=()):
    """Every number of a description, by its path of field names."""
    if is_dataclass(value):
        for field in fields(value):
            yield from numbers(getattr(value, field.name), (*path, field.name))
    elif isinstance(value, tuple):
        for place, item in enumerate(value):
            yield from numbers(item, (*path, place))
    elif isinstance(value, float):
        yield path, value


def with_number(value, path, number):
    if not path:
        return number
    if isinstance(value, tuple):
        return (*value[: path[0]], with_number(value[path[0]], path[1:], number), *value[path[0] + 1 :])
    return replace(value, **{path[0]: with_number(getattr(value, path[0]), path[1:], number)})


@given(parts, materials)
def test_stiffness_and_compliance_are_symmetric_positive_and_inverse(part, material):
    matrix = compliance(part, material)
    np.testing.assert_array_equal(matrix, matrix.T)
    assert np.all(np.linalg.eigvalsh(matrix) > 0.0)
    np.testing.assert_allclose(stiffness(part, material) @ matrix, np.eye(6), atol=1e-10)


@given(parts, materials)
def test_mass_is_symmetric_and_never_negative(part, material):
    matrix = mass(part, material)
    size = np.abs(matrix).max()
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-13 * size)
    assert np.linalg.eigvalsh(matrix).min() > -1e-13 * size


@given(beams, materials)
def test_mass_is_the_same_from_both_ends(part, material):
    """Turned by 180 degrees about z, a part is itself with its ends exchanged."""
    matrix = mass(part, material)
    turn = np.kron(np.array([[0.0, 1.0], [1.0, 0.0]]), np.diag([-1.0, -1.0, 1.0, -1.0, -1.0, 1.0]))
    np.testing.assert_allclose(turn.T @ matrix @ turn, matrix, atol=1e-12 * np.abs(matrix).max())


@given(beams, materials, st.data())
def test_a_complex_step_is_the_derivative(part, material, data):
    """Compliance and mass, by every number of part and material, against central differences."""
    together = {"part": part, "material": material}
    owner = data.draw(st.sampled_from(sorted(together)))
    path, value = data.draw(st.sampled_from(list(numbers(together[owner]))))

    def read(number):
        changed = together | {owner: with_number(together[owner], path, number)}
        return compliance(changed["part"], changed["material"]), mass(changed["part"], changed["material"])

    step = 1e-4 * max(abs(value), 0.1)
    for exact, *four in zip(read(value + 1e-30j), *(read(value + k * step) for k in (-2, -1, 1, 2)), strict=True):
        difference = (four[0] - 8.0 * four[1] + 8.0 * four[2] - four[3]) / (12.0 * step)
        scale = np.abs(exact.real).max(axis=-1, keepdims=True) / max(abs(value), 0.1)
        assert np.all(np.abs(exact.imag / 1e-30 - difference) <= 1e-7 * scale)


@given(beams, materials, materials, st.data())
def test_a_batch_is_its_designs_one_by_one(part, material, second, data):
    """One number of the part and one of the material as batch axes of their own."""
    path, value = data.draw(st.sampled_from(list(numbers(part))))
    batch = with_number(part, path, np.array([value, 1.25 * value]))
    steels = replace(material, young=np.array([[material.young], [second.young], [1.0]]))
    for read in (compliance, mass):
        together = read(batch, steels)
        alone = [[read(with_number(part, path, v), replace(material, young=e)) for v in (value, 1.25 * value)] for e in steels.young[:, 0]]
        together, alone = np.broadcast_arrays(together, np.array(alone))
        np.testing.assert_allclose(together, alone, rtol=1e-12, atol=1e-14 * np.abs(alone).max())


@given(beams, materials, st.floats(0.5, 3.0), st.floats(0.5, 3.0))
def test_compliance_and_mass_scale_with_size_modulus_and_density(part, material, size, factor):
    """Lengths by `size`, E by `factor`: C_F by 1/(size E), C_M by 1/(size^3 E); rho by `factor`: M by size^3, size^5."""
    assume(not isinstance(part, Piezo))
    grown = part
    for path, value in numbers(part):
        grown = with_number(grown, path, value if path[-1] in ("angle", "exponent") else size * value)
    large = replace(material, young=factor * material.young, density=factor * material.density)
    arm = np.repeat([1.0, size], 3)
    expected = compliance(part, material) / (size * factor) / np.outer(arm, arm)
    np.testing.assert_allclose(compliance(grown, large), expected, rtol=1e-11)
    arm = np.tile(arm, 2)
    expected = mass(part, material) * factor * size**3 * np.outer(arm, arm)
    np.testing.assert_allclose(mass(grown, large), expected, rtol=1e-9, atol=1e-13 * np.abs(expected).max())


@given(sizes, sizes, profiles, materials)
def test_exchanging_thickness_and_width_exchanges_the_axes(thickness, width, profile, material):
    """A quarter turn about x: y -> z, z -> -y, of compliance and mass."""
    first, second = (Neck("m", thickness=a, width=b, profile=profile) for a, b in ((thickness, width), (width, thickness)))
    turn = np.zeros((6, 6))
    turn[[0, 1, 2, 3, 4, 5], [0, 2, 1, 3, 5, 4]] = (1.0, 1.0, -1.0, 1.0, 1.0, -1.0)
    for read, carry in ((compliance, turn), (mass, np.kron(np.eye(2), turn))):
        expected = carry @ read(first, material) @ carry.T
        np.testing.assert_allclose(read(second, material), expected, rtol=1e-9, atol=1e-13 * np.abs(expected).max())


@given(sizes, sizes, sizes, materials)
def test_a_straight_hinge_is_the_same_notch_or_neck(thickness, width, length, material):
    notch = compliance(Notch("m", thickness=thickness, width=width, profile=Straight(length)), material)
    neck = compliance(Neck("m", thickness=thickness, width=width, profile=Straight(length)), material)
    np.testing.assert_allclose(neck, notch, rtol=1e-12)


@given(sizes, sizes, profiles, materials)
def test_growing_width_stiffens(thickness, width, profile, material):
    narrow, wide = (
        np.diag(compliance(Notch("m", thickness=thickness, width=each, profile=profile), material)) for each in (width, 1.1 * width)
    )
    assert np.all(wide < narrow)


@given(parts, materials)
def test_ordinary_parts_lock_nothing(part, material):
    found = law(part, material)
    assert found.locked == ()
    np.testing.assert_array_equal(found.stiffness, stiffness(part, material))


@given(subsets)
def test_joints_lock_what_is_not_free(free):
    found = law(Joint(free), None)
    assert set(found.locked) == set(ALL) - set(free)
    assert not found.stiffness.any()


@given(parts, materials, subsets, st.data())
def test_restricted_parts_are_the_limit_of_stiff_and_soft_springs(part, material, kept, data):
    """Springs one by one: a locked freedom is left out, a freed one takes K_i K_i^T / K_ii from the others."""
    elastic = tuple(each for each in kept if data.draw(st.booleans()))
    free = tuple(each for each in kept if each not in elastic)
    found = law(Restricted(part, elastic=elastic, free=free), material)
    assert set(found.locked) == set(ALL) - set(kept)
    own = stiffness(part, material)
    scale = np.sqrt(np.diag(own))
    soft = own / np.outer(scale, scale)
    for each in free:
        rows = [freedom.index for freedom in kept]
        pivot = each.index
        block = soft[np.ix_(rows, rows)] - np.outer(soft[rows, pivot], soft[pivot, rows]) / soft[pivot, pivot]
        soft = soft.copy()
        soft[np.ix_(rows, rows)] = block
        soft[pivot], soft[:, pivot] = 0.0, 0.0
        soft[pivot, pivot] = 1.0
    rows = [freedom.index for freedom in elastic]
    expected = np.zeros((6, 6))
    expected[np.ix_(rows, rows)] = soft[np.ix_(rows, rows)]
    np.testing.assert_allclose(found.stiffness / np.outer(scale, scale), expected, atol=1e-9)


@given(beams, materials, st.integers(0, 2**32 - 1), st.floats(-3.0, 3.0))
def test_stress_grows_in_proportion_to_the_load(part, material, seed, factor):
    wrench = np.random.default_rng(seed).normal(size=6)
    one, scaled = stress(part, material, wrench), stress(part, material, factor * wrench)
    if one is None:
        assert isinstance(part, Piezo) or isinstance(part.profile, Power | FreeForm)
    else:
        assert scaled.nominal == pytest.approx(abs(factor) * one.nominal, rel=1e-10, abs=1e-12)
        assert one.peak >= one.nominal


def test_a_missing_material_is_a_lesson():
    with pytest.raises(DesignError, match="Pass the material steel"):
        compliance(Rod("steel", length=1.0, diameter=0.1), None)


def test_freedoms_are_in_the_order_of_the_matrix():
    assert [freedom.index for freedom in (Freedom.X, Freedom.RZ)] == [0, 5]
