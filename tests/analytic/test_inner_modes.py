"""Modes of leaves and rods themselves: Euler's clamped beam, Saint-Venant's torsion, plates as elements; what they leave as it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.assessment.sensitivities import sensitivities
from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.linear_statics.drift import drift
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.loaded.stability import stability
from flexstage.base.finding import DesignError
from flexstage.base.units.scale import Y, mm
from flexstage.beams.compliance import fixed_end_modes, law
from flexstage.beams.mass import law_and_mass, mass
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism
from flexstage.mechanism.store import dumps, loads
from flexstage.models.batch.engine import plan, platform_modes
from flexstage.models.ideal import ideal
from flexstage.models.linear.eigen import eigen
from flexstage.models.lumped import lumped
from flexstage.parts.body import Body, Inertia
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.rod import Rod
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.results.read import read_solid, solids

STEEL = Material(young=200e9, poisson=0.3, density=7800.0, expansion=12e-6, loss_factor=0.01)
LEAF = Leaf("steel", length=50 * mm, thickness=0.25 * mm, width=10 * mm, inner_modes=3)
BEAM = replace(LEAF, section=LeafSection.BEAM)
ROD = Rod("steel", length=50 * mm, diameter=0.3 * mm, inner_modes=3)
CLAMPED = np.array([22.3733, 61.6728, 120.903])
FREE = np.array([3.51602, 22.0345, 61.6972])


def stage(part, body=None):
    """A heavy platform that hangs on one leaf or rod."""
    heavy = Body(mass=1.0, centre=(0.0, 0.0, -0.05), inertia=Inertia(1e-3, 1e-3, 1e-3))
    link = Link((GROUND, PLATFORM), "leaf", at=(0.0, 0.0, 0.0), along=(0.0, 0.0, -1.0), bends=Y)
    found = Mechanism("hanging", {"steel": STEEL}, {"leaf": part}, {PLATFORM: body or heavy}, {"leaf": link}, ground="steel")
    assert check(found) == ()
    return found


def unit(part):
    """(E I / (rho A L^4))^(1/2) [1/s]."""
    radius = part.diameter / 4.0 if isinstance(part, Rod) else part.thickness / 12.0**0.5
    return (STEEL.young / STEEL.density) ** 0.5 * radius / part.length**2


@pytest.mark.parametrize(("part", "count"), [(BEAM, 1), (ROD, 2)])
def test_bending_modes_of_a_clamped_beam(part, count):
    """Euler: 22.3733, 61.6728, 120.903; shear and rotary inertia take less than 0.1 % at these lengths."""
    found = [mode.squares**0.5 / unit(part) for mode in fixed_end_modes(part, STEEL) if mode.turned is not None]
    assert len(found) == count
    for each in found:
        np.testing.assert_allclose(each, CLAMPED, rtol=1e-3)


def test_twist_of_a_round_rod():
    """n pi (G / rho)^(1/2) / L: a circle does not warp, its moment of inertia is its torsion constant."""
    twist = fixed_end_modes(ROD, STEEL)[-1].squares ** 0.5
    np.testing.assert_allclose(twist, np.arange(1, 4) * np.pi / ROD.length * (STEEL.shear / STEEL.density) ** 0.5, rtol=1e-8)


@pytest.mark.parametrize(("count", "error"), [(0, 0.6), (1, 5e-3), (2, 2e-3), (3, 1e-3)])
def test_a_clamped_free_beam_needs_few_modes(count, error):
    """Ends move by static shapes, and few modes of held ends add the rest (Craig & Bampton 1968): 3.51602, 22.0345."""
    light = lumped(stage(replace(BEAM, inner_modes=count), Body(reference=(0.0, 0.0, -0.025))))
    found = eigen(light).values ** 0.5 / unit(BEAM)
    nearest = [found[np.argmin(np.abs(found - wanted))] for wanted in FREE[:2]]
    np.testing.assert_allclose(nearest, FREE[:2], rtol=error)


def test_a_rod_bends_alike_both_ways():
    """Clamped-free: every frequency of Euler's twice, across y and across z."""
    light = lumped(stage(ROD, Body(reference=(0.0, 0.0, -0.025))))
    found = eigen(light).values ** 0.5 / unit(ROD)
    for wanted in FREE[:2]:
        pair = np.sort(np.abs(found / wanted - 1.0))[:2]
        np.testing.assert_allclose(pair, pair[0], atol=1e-7)
        assert pair[1] < 2e-3


def test_wide_leaf_of_a_component_library():
    """Clamped-free silicon leaf, 100 x 20 x 2 um: modes of an ANSYS model [kHz] (Kolchuzhin, LMGT_MEMS_component_library, clamped_beam).

    Bending 275.44 and 1733.7, in its plane 2684.3, twist 3011.6 and 9206.6. The massless platform keeps the tip from warping, which is
    free there; the source's third bending mode lies above any beam's or plate's, presumably by its mesh. The solid model of this package,
    with that tip, has 275.30, 1722.5, 2681.2, 2945.4 and 8979.5: theory is within 0.15 % of it, and 0.7 % in the leaf's plane.
    """
    silicon = Material(young=169e9, poisson=0.066, density=2329.0)
    blade = Leaf("steel", 100e-6, 2e-6, 20e-6, inner_modes=4)
    tip = replace(stage(blade, Body(reference=(0.0, 0.0, -50e-6))), materials={"steel": silicon})
    found = eigen(lumped(tip)).values ** 0.5 / (2000.0 * np.pi)
    for printed, error in ((275.44, 0.001), (1733.7, 0.007), (2684.3, 0.006), (3011.6, 0.024), (9206.6, 0.024)):
        assert found[np.argmin(np.abs(found - printed))] == pytest.approx(printed, rel=error)


def test_a_wide_short_leaf_is_a_plate():
    """Bending between the beam's and 1 / (1 - nu^2)^(1/2) times it, twist above Saint-Venant's: both as clamped ends make them."""
    limit = (1.0 - STEEL.poisson**2) ** -0.5
    ratios = []
    for width in (0.5, 2.0, 10.0, 50.0, 200.0):
        part = replace(LEAF, length=200 * mm, width=width * mm)
        bending, twist = (mode.squares**0.5 for mode in fixed_end_modes(part, STEEL))
        plain, free = (mode.squares**0.5 for mode in fixed_end_modes(replace(part, section=LeafSection.BEAM), STEEL))
        ratios.append(bending[0] / plain[0])
        assert np.all(twist > free)
    assert ratios == sorted(ratios)
    assert ratios[0] == pytest.approx(1.0, abs=4e-3)  # a layer of a four-hundredth at each end is more than its polynomials follow
    assert ratios[-1] == pytest.approx(limit, rel=0.01)


@pytest.mark.parametrize("part", [LEAF, BEAM, ROD])
def test_statics_and_mass_are_those_of_the_part_without_modes(part):
    plain = replace(part, inner_modes=0)
    one, other = law(part, STEEL), law(plain, STEEL)
    assert np.array_equal(one.stiffness, other.stiffness)
    assert other.inner is None
    whole = mass(part, STEEL)
    assert np.array_equal(whole[:12, :12], mass(plain, STEEL))
    scale = np.sqrt(np.diag(whole))
    np.testing.assert_allclose((whole - whole.T) / scale / scale[:, None], 0.0, atol=1e-14)
    assert np.linalg.eigvalsh(whole / scale / scale[:, None])[0] > -1e-12
    assert np.array_equal(law_and_mass(part, STEEL)[1], whole)
    mine, theirs = lumped(stage(part)), lumped(stage(plain))
    assert np.array_equal(statics(mine).stiffness.values, statics(theirs).stiffness.values)
    rigid = [model.rigid.T @ model.inertia_matrix @ model.rigid for model in (mine, theirs)]
    np.testing.assert_allclose(rigid[0], rigid[1], rtol=1e-14)
    drifted = [drift(each, lumped(each)) for each in (stage(part), stage(plain))]
    np.testing.assert_allclose(drifted[0].motion.values, drifted[1].motion.values, rtol=1e-12, atol=1e-20)
    assert stability(stage(part), mine).dead == pytest.approx(stability(stage(plain), theirs).dead, rel=1e-9)
    assert ideal(stage(part)).mobility == ideal(stage(plain)).mobility


def test_modes_are_called_by_their_link():
    found = lumped(stage(LEAF))
    assert found.coordinates[6:] == tuple(f"leaf.mode{number}" for number in range(1, 7))
    named = modes(found).names
    assert named.count("leaf (link) local") == 6


@pytest.mark.parametrize("address", ["parts.leaf.length", "parts.leaf.thickness", "parts.leaf.width", "materials.steel.poisson"])
def test_sensitivities_pass_through_the_modes(address):
    """The complex step against central differences, in frequencies of the platform and of the leaf."""
    whole = stage(LEAF)
    slopes = sensitivities(whole, (address,), modes=9).frequency[0]
    value = get(whole, address)
    step = 1e-3 * value
    high, low = (modes(lumped(set_value(whole, address, value + side * step))).frequencies[:9] for side in (1, -1))
    np.testing.assert_allclose(slopes, (high - low) / (2.0 * step), rtol=1e-4, atol=1e-6 * np.max(high) / value)


def test_batches_are_single_designs_one_by_one():
    widths = np.array([5.0, 10.0, 20.0]) * mm
    batch = lumped(stage(replace(LEAF, width=widths)))
    for number, width in enumerate(widths):
        single = lumped(stage(replace(LEAF, width=float(width))))
        for name in ("stiffness_matrix", "inertia_matrix"):
            mine, theirs = getattr(batch, name)[number], getattr(single, name)
            np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-11 * np.abs(theirs).max())


def test_studies_of_many_designs_know_them():
    values = np.array([[0.2], [0.3]]) * mm
    found = platform_modes(plan(stage(LEAF), ("parts.leaf.thickness",)), values)
    for number, (value,) in enumerate(values):
        single = modes(lumped(stage(replace(LEAF, thickness=float(value)))))
        np.testing.assert_allclose(found.frequencies[number], single.frequencies[list(single.platform)], rtol=1e-8)


def test_files_and_what_is_refused():
    assert loads(dumps(stage(LEAF))) == stage(LEAF)
    assert "inner_modes = 3" in dumps(stage(LEAF))
    with pytest.raises(DesignError, match=r"Leaf\.inner_modes: must be a whole number \(got 1\.5\)"):
        replace(LEAF, inner_modes=1.5)


FULL = pytest.mark.full


@pytest.mark.parametrize(
    ("size", "order", "error"),
    [
        ((10, 0.5, 2), 3, (0.004, 0.04)),
        pytest.param((20, 0.5, 4), 3, (0.002, 0.015), marks=FULL),
        pytest.param((20, 0.2, 4), 3, (0.001, 0.003), marks=FULL),
        pytest.param((20, 0.2, 10), 4, (0.005, 0.003), marks=FULL),
    ],
)
def test_modes_of_solids(size, order, error):
    """Two of bending, two of twist (in full three) of a leaf below a heavy platform; thick ones, here t/b = 1/4, twist more slowly."""
    part = Leaf("steel", *(value * mm for value in size), inner_modes=2 if size[0] == 10 else 3)
    whole = stage(part, Body(mass=5.0, centre=(0.0, 0.0, -0.05), inertia=Inertia(1e-2, 1e-2, 1e-2)))
    fineness = Fineness(neck=2.5, block=2.5, grading=0.6, order=order)
    solid = read_solid(whole, Reduction(fineness, modes=12), solids()).model
    seen = np.sqrt(eigen(solid).values)[6:]
    for held, allowed in zip(fixed_end_modes(part, STEEL), error, strict=True):
        for own in held.squares**0.5:
            assert seen[np.argmin(np.abs(seen - own))] == pytest.approx(own, rel=allowed)
