"""Nominal stress in hinges: textbook cases, and the throat's share."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.beams.stress import stress
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.leaf import Leaf
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular, Elliptic, Filleted, Straight
from flexstage.parts.rod import Rod
from tests.analytic.hinges import STEEL

NOTCH = Notch("m", thickness=1.0, width=10.0, profile=Circular(5.0))


def load(**components):
    return np.array([components.get(name, 0.0) for name in ("fx", "fy", "fz", "mx", "my", "mz")])


def test_notch_in_bending_and_tension():
    """6 M / (b t^2) + N / (b t) at the throat, times K_t."""
    found = stress(NOTCH, STEEL, load(fx=-30.0, mz=2.0))
    assert found.nominal == pytest.approx(6.0 * 2.0 / 10.0 + 30.0 / 10.0, rel=1e-13)
    assert found.position == pytest.approx(0.0, abs=1e-15)
    assert found.peak / found.nominal == pytest.approx((1.0 + 0.1) ** 0.45, rel=1e-13)


def test_leaf_carries_its_moment_at_both_ends():
    """Guided by a force: F L / 2 at the ends, 3 F L / (b t^2)."""
    found = stress(Leaf("m", length=50.0, thickness=0.5, width=10.0), STEEL, load(fy=1.0))
    bending, shear = 3.0 * 50.0 / (10.0 * 0.25), 1.5 / 5.0
    assert found.nominal == pytest.approx(np.sqrt(bending**2 + 3.0 * shear**2), rel=1e-13)
    assert abs(found.position) == pytest.approx(25.0, rel=1e-15)
    assert found.factor == 1.0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_end_is_found_where_moment_and_force_add(side):
    """M_z(x) = m_z - x F_y: with both positive the first end carries more."""
    found = stress(Rod("m", length=40.0, diameter=2.0), STEEL, load(fy=1.0, mz=side * 5.0))
    moment = 5.0 + 20.0
    assert found.position == pytest.approx(-side * 20.0)
    assert found.nominal == pytest.approx(np.hypot(32.0 * moment / (np.pi * 8.0), np.sqrt(3.0) * 4.0 / (3.0 * np.pi)), rel=1e-12)


def test_a_leaf_loaded_at_its_tip_both_ways_bears_both_moments_at_its_root():
    """A cantilever of length L under F_y and F_z at its second end: 6 F_y L / (b t^2) + 6 F_z L / (t b^2), both at the first end."""
    leaf = Leaf("m", length=40.0, thickness=1.0, width=10.0)
    along, across = 3.0, 2.0
    found = stress(leaf, STEEL, load(fy=along, fz=across, my=-20.0 * across, mz=20.0 * along))
    shear = 1.5 * np.hypot(along, across) / 10.0
    bending = 6.0 * along * 40.0 / 10.0 + 6.0 * across * 40.0 / 100.0
    assert found.nominal == pytest.approx(np.sqrt(bending**2 + 3.0 * shear**2), rel=1e-9)
    assert found.position == pytest.approx(-20.0, rel=1e-12)


def test_moments_about_both_axes_add_as_vectors_in_a_round_neck():
    found = stress(Neck("m", thickness=1.0, profile=Circular(5.0)), STEEL, load(my=3.0, mz=4.0))
    assert found.nominal == pytest.approx(32.0 * 5.0 / np.pi, rel=1e-13)


def test_the_notch_factor_of_a_rectangular_neck_is_that_of_its_larger_side():
    """(1 + b / 2R)^(9/20) for bending across the width b, whichever side is called the width."""
    for thickness, width in ((1.0, 3.0), (3.0, 1.0)):
        found = stress(Neck("m", thickness=thickness, width=width, profile=Circular(5.0)), STEEL, load(my=1.0, mz=1.0))
        assert found.factor == pytest.approx((1.0 + 0.3) ** 0.45, rel=1e-13)


def test_torsion_of_round_and_of_slender_rectangular_necks():
    """16 T / (pi d^3); far from the ends T / (0.208 a^3) in a square (Timoshenko & Goodier, section 109)."""
    rod = stress(Rod("m", length=40.0, diameter=2.0), STEEL, load(mx=1.0))
    assert rod.nominal == pytest.approx(np.sqrt(3.0) * 16.0 / (np.pi * 8.0), rel=1e-13)
    square = stress(Neck("m", thickness=1.0, width=1.0, profile=Straight(40.0)), STEEL, load(mx=1.0))
    assert square.nominal == pytest.approx(np.sqrt(3.0) / 0.208, rel=1e-3)


def test_wide_notch_in_torsion_is_bent_strip_by_strip():
    """The strip at z carries the force q = T z / (b^3 / 12) per width; its ends bend by q L / 2, sigma = 6 (q L / 2) / t^2."""
    wide = Notch("m", thickness=1.0, width=2000.0, profile=Straight(10.0))
    torque = 1.0e6
    found = stress(wide, STEEL, load(mx=torque))
    force = 6.0 * torque / 2000.0**2
    bending, shear = 6.0 * force * 5.0, 1.5 * force
    assert found.nominal == pytest.approx(np.sqrt(bending**2 + 3.0 * shear**2), rel=2e-3)
    assert abs(found.position) == pytest.approx(5.0)


def test_notch_factors_use_the_radius_at_the_throat():
    for profile, radius in ((Elliptic(5.0, 2.0), 12.5), (Filleted(12.0, 2.0), 2.0)):
        found = stress(Notch("m", thickness=1.0, width=10.0, profile=profile), STEEL, load(mz=1.0))
        assert found.factor == pytest.approx((1.0 + 0.5 / radius) ** 0.45, rel=1e-14)


def test_parts_without_a_section_and_restricted_parts():
    assert stress(Joint(), None, load(fx=1.0)) is None
    assert stress(Piezo(stroke=0.1, stiffness=1e3, length=10.0, diameter=5.0), None, load(fx=1.0)) is None
    restricted = Restricted(NOTCH, elastic=())
    assert stress(restricted, STEEL, load(mz=2.0)).nominal == stress(NOTCH, STEEL, load(mz=2.0)).nominal


def test_batches_of_loads_and_of_hinges():
    loads = np.stack([load(mz=1.0), load(fx=5.0), load(fy=1.0, mx=2.0)])
    found = stress(NOTCH, STEEL, loads)
    single = [stress(NOTCH, STEEL, each) for each in loads]
    np.testing.assert_allclose(found.peak, [each.peak for each in single], rtol=1e-14)
    hinges = stress(Notch("m", thickness=np.array([1.0, 2.0]), width=10.0, profile=Circular(5.0)), STEEL, loads[:1])
    np.testing.assert_allclose(hinges.nominal, [0.6, 0.15], rtol=1e-13)
