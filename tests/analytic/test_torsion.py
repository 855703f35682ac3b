"""Torsion of rectangles and hinges: Saint-Venant's series, and the two limits of constrained warping (reference B5, B6)."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

from flexstage.beams.quadrature import stations
from flexstage.beams.torsion import constrained_twist
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular, Straight
from flexstage.parts.section import Rectangle, rectangle_torsion
from tests.analytic.hinges import STEEL, UNIT, diagonal


def series(short, long):
    """Timoshenko & Goodier, section 109, summed to the end."""
    n = np.arange(1.0, 20001.0, 2.0)
    return short**3 * long / 3.0 * (1.0 - 192.0 / np.pi**5 * short / long * np.sum(np.tanh(0.5 * n * np.pi * long / short) / n**5))


@pytest.mark.parametrize("long", [1.0, 1.2, 2.0, 5.0, 100.0])
def test_saint_venant_constant_of_a_rectangle(long):
    assert rectangle_torsion(1.0, long) == pytest.approx(series(1.0, long), rel=1e-14)
    assert rectangle_torsion(long, 1.0) == pytest.approx(series(1.0, long), rel=1e-14)


def test_saint_venant_constant_is_smooth_through_the_square():
    """Both branches are the same analytic function: their slopes at the square agree."""
    below, above = (rectangle_torsion(1.0, 1.0 + side + 1e-30j).imag / 1e-30 for side in (-1e-12, 1e-12))
    assert below == pytest.approx(above, rel=1e-10)


def prismatic(t, b, length):
    """Constant section: L / (G (J + S r^2)) + (f^2 / g) L (1 - tanh(lam) / lam) solves the same equation (f, g as in beams.torsion)."""
    torsion, stiffness = series(min(t, b), max(t, b)), t * b * (t**2 + b**2) / 12.0 / 1.2
    skew = (b**2 - t**2) / (b**2 + t**2)
    whole = torsion + stiffness * skew**2
    load, spring = stiffness * skew / whole, UNIT.shear * stiffness * torsion / whole
    lam = 0.5 * length * np.sqrt(spring / (UNIT.young * (b * t) ** 3 / 144.0))
    return length / (UNIT.shear * whole) + load**2 / spring * length * (1.0 - np.tanh(lam) / lam)


PRISMS = ((1.0, 8.0, 6.0, 1e-12), (1.0, 0.7, 6.0, 1e-12), (0.1, 2.0, 60.0, 2e-9), (0.02, 2.0, 400.0, 2e-5))


@pytest.mark.parametrize(("t", "b", "length", "tolerance"), PRISMS)
def test_prismatic_warping_in_closed_form(t, b, length, tolerance):
    """Rounding for hinges; 2e-5 where the end zones of 0.2 b are a thousandth of the length."""
    found = diagonal(Notch("m", thickness=t, width=b, profile=Straight(length)), UNIT)[3]
    assert found == pytest.approx(prismatic(t, b, length), rel=tolerance)


def test_a_hinge_of_many_is_told_as_if_alone():
    """To the bit, whichever way its neighbours are solved: one of them is too long for its stations."""
    lengths, one = np.array([0.01, 0.3, 0.02]), np.ones((3, 1))

    def twist(which):
        points = stations(Straight(lengths[which]), np.full(len(lengths[which]), 0.001))
        section = Rectangle(
            np.broadcast_to(0.001 * one[which], points.growth.shape), np.broadcast_to(0.01 * one[which], points.growth.shape)
        )
        return constrained_twist(section, points, 2.6 * one[which], one[which])

    together = twist(slice(None))
    for number in range(3):
        alone = twist(slice(number, number + 1))
        assert np.array_equal(alone.rate[0], together.rate[number])
        assert np.array_equal(alone.bimoment[0], together.bimoment[number])


def test_slender_hinges_are_saint_venants():
    """Long against its width, a straight hinge twists by L / (G J), less the ends: 1 - 1/lam, lam = (L/b) sqrt(6 / (1 + nu))."""
    length, lam = 400.0, 400.0 / 2.0 * np.sqrt(6.0 / 1.3)
    found = diagonal(Notch("m", thickness=0.02, width=2.0, profile=Straight(length)), UNIT)[3]
    free = length / (UNIT.shear * series(0.02, 2.0))
    assert found / free == pytest.approx(1.0 - 1.0 / lam, abs=2e-5)


def test_square_necks_do_not_warp():
    """Grown on both sides, a square neck stays square: C = integral of dx / (G J) exactly."""
    found = diagonal(Neck("m", thickness=1.0, width=1.0, profile=Circular(5.0)))[3]
    square = series(1.0, 1.0) * STEEL.shear
    expected = scipy.integrate.quad(
        lambda p: 5.0 * np.cos(p) / (square * (11.0 - 10.0 * np.cos(p)) ** 4), -np.pi / 2, np.pi / 2, points=[0.0], epsabs=0
    )[0]
    assert found == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("profile", [Circular(5.0), Straight(10.0)])
def test_wide_hinges_bend_strip_by_strip(profile):
    """C_rx -> 12 C_y / b^2 as the width grows, with an error that falls as 1 / b^2."""
    ratios = []
    for width in (500.0, 1000.0):
        found = diagonal(Notch("m", thickness=1.0, width=width, profile=profile))
        ratios.append(found[3] * width**2 / (12.0 * found[1]) - 1.0)
    assert abs(ratios[1]) < 2e-4
    assert ratios[0] / ratios[1] == pytest.approx(4.0, rel=0.02)


def twisting(thickness, points):
    section = Rectangle(thickness, np.full_like(thickness, 0.01))
    return constrained_twist(section, points, np.full(1, UNIT.young), np.full(1, UNIT.shear))


def test_uniform_sections_twist_as_the_equation_at_stations_says():
    """A section that differs along the hinge by less than rounding is solved for; steps pass through both."""
    points = stations(Straight(0.03), 0.002)
    same = np.full(points.position.shape, 0.002 + 1e-24j)
    found, expected = twisting(same, points), twisting(same * (1.0 + 1e-15 * (points.position > 0.0)), points)
    for one, other in ((found.rate, expected.rate), (found.bimoment, expected.bimoment)):
        np.testing.assert_allclose(np.real(one), np.real(other), atol=1e-11 * np.max(np.abs(other)))
        np.testing.assert_allclose(np.imag(one), np.imag(other), atol=1e-10 * np.max(np.abs(np.imag(other))))


def test_steps_beside_one_another_are_each_alone():
    """Steps that share real numbers, and those that do not, as if each were solved for itself."""
    points = stations(Circular(0.01), 0.002)
    for thicker in (0.0, 1e-4):
        both = np.array([[0.002 + 1e-24j], [0.002 + thicker + 3e-24j]])[..., None] + 2.0 * points.growth
        alone = [twisting(each, points).rate for each in both]
        np.testing.assert_allclose(np.imag(twisting(both, points).rate), np.imag(alone), rtol=1e-10)
