"""Consistent mass of parts: textbook beams, and the solid's own mass and inertia."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

from flexstage.beams.mass import mass
from flexstage.parts.compliance_matrix import ComplianceMatrix, Joint
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular, Elliptic, Filleted, Straight
from flexstage.parts.rod import Rod
from flexstage.spatial.frame import transport

BEAM = Material(young=200e9, poisson=0.0, density=8000.0)


def at_ends(matrix, length):
    """The mass for the twists of the ends at the ends themselves."""
    carry = np.zeros((12, 12))
    carry[:6, :6], carry[6:, 6:] = (transport(np.array([side * 0.5 * length, 0.0, 0.0])) for side in (1.0, -1.0))
    return carry.T @ matrix @ carry


def rigid(matrix):
    """Inertia of the part moving as one body, at its centre."""
    return sum(matrix[i : i + 6, j : j + 6] for i in (0, 6) for j in (0, 6))


def test_slender_leaf_is_the_textbook_beam():
    """rho A L / 420 [156, 22 L, 54, -13 L; ...] across the thickness, rho A L / 6 [2, 1; 1, 2] along it."""
    length = 0.5
    found = at_ends(mass(Leaf("m", length=length, thickness=1e-5, width=0.01), BEAM), length)
    total = BEAM.density * 1e-7 * length
    bending = np.array(
        [
            [156.0, 22.0 * length, 54.0, -13.0 * length],
            [22.0 * length, 4.0 * length**2, 13.0 * length, -3.0 * length**2],
            [54.0, 13.0 * length, 156.0, -22.0 * length],
            [-13.0 * length, -3.0 * length**2, -22.0 * length, 4.0 * length**2],
        ]
    )
    rows = np.array([1, 5, 7, 11])
    np.testing.assert_allclose(found[np.ix_(rows, rows)], total / 420.0 * bending, rtol=1e-7)
    np.testing.assert_allclose(found[np.ix_([0, 6], [0, 6])], total / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]]), rtol=1e-12)


def test_rod_turns_with_a_third_at_each_end():
    """rho I_p L / 6 [2, 1; 1, 2]."""
    found = mass(Rod("m", length=0.2, diameter=0.004), BEAM)
    polar = BEAM.density * np.pi * 0.004**4 / 32.0 * 0.2
    np.testing.assert_allclose(found[np.ix_([3, 9], [3, 9])], polar / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]]), rtol=1e-12)


NOTCHES = (
    (Circular(0.005), lambda x: 0.001 + 2.0 * (0.005 - np.sqrt(0.005**2 - x**2)), 0.005),
    (Elliptic(0.005, 0.002), lambda x: 0.001 + 2.0 * 0.002 * (1.0 - np.sqrt(1.0 - (x / 0.005) ** 2)), 0.005),
    (Filleted(0.012, 0.002), lambda x: 0.001 + 2.0 * (0.002 - np.sqrt(0.002**2 - max(abs(x) - 0.004, 0.0) ** 2)), 0.006),
    (Straight(0.01), lambda x: 0.001 + 0.0 * x, 0.005),
)


@pytest.mark.parametrize(("profile", "height", "half"), NOTCHES, ids=lambda each: type(each).__name__)
def test_notch_moved_rigidly_is_its_solid(profile, height, half):
    """Mass and inertia of the solid between the arc ends, integrated from its outline by another quadrature."""

    def integral(function):
        half_integral = scipy.integrate.quad(lambda x: height(x) * function(x), 0.0, half, points=[0.004], epsabs=0.0, epsrel=1e-11)[0]
        return BEAM.density * 0.012 * 2.0 * half_integral

    total, along, across = integral(lambda x: x**0), integral(lambda x: x**2), integral(lambda x: height(x) ** 2 / 12.0)
    sideways = total * 0.012**2 / 12.0
    found = rigid(mass(Notch("m", thickness=0.001, width=0.012, profile=profile), BEAM))
    expected = np.diag([total, total, total, across + sideways, sideways + along, across + along])
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * total)


def test_circular_notch_mass_in_closed_form():
    """rho b (2 R t + (4 - pi) R^2), to rounding."""
    found = rigid(mass(Notch("m", thickness=0.001, width=0.012, profile=Circular(0.005)), BEAM))
    expected = BEAM.density * 0.012 * (2.0 * 0.005 * 0.001 + (4.0 - np.pi) * 0.005**2)
    np.testing.assert_allclose(np.diag(found)[:3], expected, rtol=1e-13)


def test_toroid_and_stack_moved_rigidly():
    """A toroid of diameter d(x): integral of pi d^2 / 4; a stack keeps its stated mass and is a uniform cylinder."""
    radius, throat = 0.008, 0.00237
    found = rigid(mass(Neck("m", thickness=throat, profile=Circular(radius)), BEAM))
    outer = throat + 2.0 * radius
    volume = 0.25 * np.pi * (2.0 * outer**2 * radius - 2.0 * outer * np.pi * radius**2 + 16.0 * radius**3 / 3.0)
    assert found[0, 0] == pytest.approx(BEAM.density * volume, rel=1e-13)
    stack = rigid(mass(Piezo(stroke=1e-4, stiffness=17e6, length=0.162, diameter=0.01, mass=0.18, bending_rigidity=180.0), None))
    across = 0.18 * (0.162**2 / 12.0 + 0.005**2 / 4.0)
    np.testing.assert_allclose(np.diag(stack), [0.18, 0.18, 0.18, 0.18 * 0.005**2 / 2.0, across, across], rtol=1e-13)


def test_parts_without_shape():
    """A given part has half its mass at each end; joints and restricted parts have none."""
    unit = tuple(tuple(float(i == j) for j in range(6)) for i in range(6))
    found = mass(ComplianceMatrix(unit, free=(), mass=3.0), None)
    np.testing.assert_array_equal(np.diag(found), [1.5, 1.5, 1.5, 0.0, 0.0, 0.0] * 2)
    assert not mass(Joint(), None).any()
    assert not mass(Restricted(Rod("m", length=1.0, diameter=0.1), elastic=()), BEAM).any()


def test_what_is_known_of_a_part_is_kept_by_content_but_not_of_a_batch():
    one, same, other = (Leaf("m", length=0.1, thickness=thickness, width=0.01) for thickness in (1e-3, 1e-3, 2e-3))
    many = Leaf("m", length=0.1, thickness=np.array([1e-3, 2e-3]), width=0.01)
    assert mass(one, BEAM) is mass(same, BEAM)
    assert mass(many, BEAM) is not mass(many, BEAM)
    assert np.allclose(mass(many, BEAM), [mass(one, BEAM), mass(other, BEAM)], rtol=1e-14)
