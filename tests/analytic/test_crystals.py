"""Cubic silicon by direction: Hopcroft, Nix & Kenny, J. MEMS 19 (2010) 229-238, and the full tensor."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.units.scale import mm
from flexstage.beams.compliance import compliance
from flexstage.beams.fixed_end_modes import Bending, fixed_end_bending
from flexstage.beams.leaf import leaf_modes
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.mechanism.store import dumps, loads
from flexstage.models.lumped import lumped
from flexstage.parts.body import Block, Body
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.rod import Rod
from flexstage.parts.section import cowper_rectangle
from flexstage.spatial.frame import axes

SILICON = Material(young=None, poisson=None, density=2329.0, c11=165.6e9, c12=63.9e9, c44=79.5e9)


def seen(along, up, material=SILICON):
    """The crystal as a part along one of its directions sees it, its width along another."""
    return material.oriented(axes(along, up))


@pytest.mark.parametrize(
    ("along", "up", "young"),
    [((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), 130.0), ((1.0, 1.0, 0.0), (0.0, 0.0, 1.0), 169.0), ((1.0, 1.0, 1.0), (1.0, -1.0, 0.0), 188.0)],
)
def test_youngs_modulus_is_that_of_the_paper(along, up, young):
    assert round(float(seen(along, up).young) / 1e9) == young


def test_the_wafer_100_has_the_contraction_and_shear_of_the_paper():
    """Table of the paper, orthotropic silicon in the axes 110, -110, 001: nu 0.064 and 0.36, G 79.6 and 50.9 GPa."""
    lying = seen((1.0, 1.0, 0.0), (-1.0, 1.0, 0.0))
    np.testing.assert_allclose(lying.poisson, 0.064, atol=2e-3)  # its own constants make 0.0625
    np.testing.assert_allclose([lying.shear / 1e9, lying.shear_across / 1e9], [50.9, 79.5], atol=0.1)
    upright = seen((1.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    np.testing.assert_allclose(upright.poisson * np.sqrt(upright.young / 130.0e9), 0.36, atol=5e-3)
    np.testing.assert_allclose([upright.shear / 1e9, upright.shear_across / 1e9], [79.5, 50.9], atol=0.1)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0])
def test_the_wafer_111_is_alike_in_all_directions(angle):
    one, other = np.array([1.0, -1.0, 0.0]) / np.sqrt(2.0), np.array([1.0, 1.0, -2.0]) / np.sqrt(6.0)
    along, across = (np.cos(turn) * one + np.sin(turn) * other for turn in (angle, angle + 0.5 * np.pi))
    found = seen(tuple(along), tuple(across))
    np.testing.assert_allclose(found.young / 1e9, 168.9, atol=0.1)
    np.testing.assert_allclose(found.poisson, 0.262, atol=1e-3)
    np.testing.assert_allclose(found.shear, found.young / (2.0 * (1.0 + found.poisson)), rtol=1e-12)


def full_compliance(rotation):
    """The 6x6 of engineering strains of the whole tensor, turned: an independent way to the same moduli."""
    pairs = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    voigt = np.zeros((6, 6))
    voigt[:3, :3], voigt[[0, 1, 2], [0, 1, 2]], voigt[[3, 4, 5], [3, 4, 5]] = 63.9e9, 165.6e9, 79.5e9
    tensor = np.zeros((3, 3, 3, 3))
    for (row, one), (column, other) in itertools.product(enumerate(pairs), enumerate(pairs)):
        for i, j, k, m in ((*a, *b) for a in (one, one[::-1]) for b in (other, other[::-1])):
            tensor[i, j, k, m] = voigt[row, column]
    turned = np.einsum("ai,bj,ck,dl,abcd->ijkl", rotation, rotation, rotation, rotation, tensor)
    return np.linalg.inv(np.array([[turned[*one, *other] for other in pairs] for one in pairs]))


@given(st.integers(0, 2**32 - 1))
def test_moduli_are_those_of_the_turned_tensor(seed):
    random = np.random.default_rng(seed)
    turn = axes(*(tuple(each) for each in np.linalg.qr(random.normal(size=(3, 3)))[0].T[:2]))
    found, soft = SILICON.oriented(turn), full_compliance(turn)
    np.testing.assert_allclose([found.young, found.shear, found.shear_across], 1.0 / soft[[0, 4, 5], [0, 4, 5]], rtol=1e-9)
    np.testing.assert_allclose(found.poisson, -soft[0, 2] / np.sqrt(soft[0, 0] * soft[2, 2]), rtol=1e-7, atol=1e-9)


def test_a_leaf_with_a_middle_as_thick_as_its_ends_shears_as_a_leaf():
    """In the plane of its length and thickness: 79.5 instead of 50.9 GPa, or the reverse, would change its compliance by 1 %."""
    lying, sizes = seen((1.0, 1.0, 0.0), (0.0, 0.0, 1.0)), ("silicon", 6.0 * mm, 0.5 * mm, 10.0 * mm, LeafSection.BEAM)
    reinforced = ReinforcedLeaf(*sizes, flexure_length=2.0 * mm, reinforced_thickness=0.5 * mm)
    np.testing.assert_allclose(compliance(reinforced, lying), compliance(Leaf(*sizes), lying), rtol=1e-12)


def test_a_plate_leaf_shears_in_the_plane_of_bending():
    """Twice the shear modulus of that plane halves L / (k G A) of the compliance across the leaf."""
    lying, leaf = seen((1.0, 1.0, 0.0), (0.0, 0.0, 1.0)), Leaf("silicon", 6.0 * mm, 0.5 * mm, 10.0 * mm)
    soft, stiff = (compliance(leaf, replace(lying, other_shear=factor * lying.shear_across))[1, 1] for factor in (1.0, 2.0))
    expected = 0.5 * cowper_rectangle(lying.contraction) * 6e-3 / (lying.shear_across * 5e-6)
    assert soft - stiff == pytest.approx(expected, rel=1e-6)


def test_modes_of_a_leaf_shear_in_the_plane_of_bending():
    """The frequency of a leaf of ten thicknesses, bent with 79.5 or 50.9 GPa, differs by 2.7 %."""
    lying, leaf = seen((1.0, 1.0, 0.0), (0.0, 0.0, 1.0)), Leaf("silicon", 10.0 * mm, 1.0 * mm, 5.0 * mm, LeafSection.BEAM, inner_modes=1)
    area, inertia = 5e-6, 5e-12 / 12.0
    bending = Bending(
        0.01, lying.young * inertia, lying.shear_across * area / cowper_rectangle(lying.contraction), 2329.0 * area, 2329.0 * inertia
    )
    found, expected = leaf_modes(leaf, lying, np.zeros(1))[0], fixed_end_bending(1, bending, 1, np.zeros(1))
    np.testing.assert_allclose(found.squares, expected.squares, rtol=1e-9)


def test_a_crystal_that_is_isotropic_is_the_isotropic_material():
    young, poisson = 100e9, 0.25
    shear = young / (2.0 * (1.0 + poisson))
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    even = seen((1.0, 2.0, 3.0), (3.0, 0.0, -1.0), replace(SILICON, c11=lame + 2.0 * shear, c12=lame, c44=shear))
    plain = Material(young=young, poisson=poisson, density=2329.0)
    for part in (Leaf("m", 0.03, 0.0005, 0.01), Leaf("m", 0.01, 0.0005, 0.03), Rod("m", 0.03, 0.001)):
        np.testing.assert_allclose(compliance(part, even), compliance(part, plain), rtol=1e-12)
    assert plain.oriented(np.eye(3)) is plain


def test_leaves_take_the_moduli_of_their_directions():
    """Limits with a closed form: a slender leaf bends by E, a wide one by the plate's E / (1 - nu^2), and twists by G in its plane."""
    cut = seen((1.0, 1.0, 0.0), (-1.0, 1.0, 0.0))
    slender, wide = (Leaf("m", length, 1e-4, width) for length, width in ((0.1, 1e-3), (1e-2, 1.0)))
    moment = [float(np.real(1.0 / compliance(leaf, cut)[5, 5] * leaf.length / (leaf.width * 1e-12 / 12.0))) for leaf in (slender, wide)]
    np.testing.assert_allclose(moment, [cut.young, cut.young / (1.0 - cut.poisson**2)], rtol=3e-3)
    thin = compliance(slender, cut)[3, 3]
    np.testing.assert_allclose(0.1 / thin / (1e-3 * 1e-12 / 3.0), cut.shear, rtol=0.1)


def wafer(crystal=None):
    silicon = replace(SILICON, crystal=crystal)
    links = {
        name: Link(("ground", "platform"), "rod", (0.0, 0.0, 0.0), along)
        for name, along in (("a", (1.0, 0.0, 0.0)), ("b", (1.0, 1.0, 0.0)))
    }
    body = Body(solids={"block": Block("silicon", (10 * mm, 10 * mm, 10 * mm))})
    return Mechanism(
        "wafer", materials={"silicon": silicon}, parts={"rod": Rod("silicon", 0.02, 0.001)}, bodies={"platform": body}, links=links
    )


@pytest.mark.parametrize(("crystal", "young"), [(None, (130, 169)), (((1.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (169, 130))])
def test_links_see_the_crystal_of_the_stage_by_their_direction(crystal, young):
    stage = wafer(crystal)
    assert not check(stage)
    assert loads(dumps(stage)) == stage
    laws = lumped(stage).stiffness
    found = [laws[name].law[0, 0] * 0.02 / (0.25 * np.pi * 1e-6) / 1e9 for name in ("a", "b")]
    assert tuple(round(float(each)) for each in found) == young


def test_moduli_are_complex_analytic():
    step = seen((1.0, 2.0, 0.0), (0.0, 0.0, 1.0), replace(SILICON, c11=165.6e9 * (1.0 + 1e-30j)))
    shifted = seen((1.0, 2.0, 0.0), (0.0, 0.0, 1.0), replace(SILICON, c11=165.6e9 * (1.0 + 1e-6)))
    here = seen((1.0, 2.0, 0.0), (0.0, 0.0, 1.0))
    np.testing.assert_allclose(np.imag(step.young) / 1e-30, (shifted.young - here.young) / 1e-6, rtol=1e-5)


@given(st.integers(0, 2**32 - 1))
def test_the_tensor_is_the_turned_one(seed):
    turn = axes(*(tuple(each) for each in np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0].T[:2]))
    np.testing.assert_allclose(SILICON.stiffness_tensor(turn) @ full_compliance(turn), np.eye(6), atol=1e-12)
    np.testing.assert_allclose(SILICON.oriented(turn).tensor, SILICON.stiffness_tensor(turn))


def test_a_link_in_a_mirrored_copy_is_drawn_in_right_handed_axes():
    turn = axes((1.0, 2.0, 3.0), (3.0, 0.0, -1.0))
    np.testing.assert_allclose(SILICON.oriented(turn * [1.0, -1.0, 1.0]).tensor, SILICON.oriented(turn).tensor)


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"c12": None}, "materials.silicon.c12: a crystal of cubic symmetry requires c11, c12, c44"),
        ({"young": 1e11}, "materials.silicon.young: redundant: c11, c12 and c44 determine it"),
        ({"c12": 170e9}, "materials.silicon.c11: unstable crystal"),
        ({"c11": None, "c12": None, "c44": None}, "materials.silicon.young: elastic constants incomplete"),
        (
            {"c11": None, "c12": None, "c44": None, "young": 2e11, "poisson": 0.3, "shear_modulus": 7e10},
            "materials.silicon.shear_modulus: young and shear_modulus give the Poisson's ratio 0.4286, but poisson is 0.3",
        ),
        (
            {"c11": None, "c12": None, "c44": None, "young": 2e11, "shear_modulus": 6e10},
            "materials.silicon.shear_modulus: young and shear_modulus give an invalid Poisson's ratio (got 0.6667",
        ),
    ],
)
def test_bad_constants_are_told(changes, what):
    stage = replace(wafer(), materials={"silicon": replace(SILICON, **changes)})
    assert any(str(finding).startswith(what) for finding in check(stage))


def test_two_of_three_moduli_make_the_third():
    steel = Material(young=200e9, poisson=0.25, density=7800.0)
    other = Material(young=200e9, poisson=None, shear_modulus=80e9, density=7800.0)
    np.testing.assert_allclose(other.contraction, 0.25, rtol=1e-15)
    for part in (Leaf("m", 0.03, 0.0005, 0.01), Rod("m", 0.03, 0.001)):
        np.testing.assert_allclose(compliance(part, other), compliance(part, steel), rtol=1e-12)
    assert not [*replace(steel, shear_modulus=79.6e9).faults]
