"""Membranes: closed forms against Ritz's method with polynomials in the radius, which knows none of their logarithms."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import Legendre

from flexstage.beams.membrane import membrane_stiffness
from flexstage.parts.material import Material
from flexstage.parts.membrane import Membrane

STEEL = Material(young=200e9, poisson=0.3, density=7750.0)
A, B, T, NU = 0.01, 0.03, 0.2e-3, 0.3
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(60)
ONE, ALONG = Legendre([1.0], [A, B]), Legendre([0.5 * (A + B), 0.5 * (B - A)], [A, B])
R, W = A + 0.5 * (B - A) * (POINTS + 1.0), 0.5 * (B - A) * WEIGHTS


def shapes(hub, clamped):
    """Radial functions that are `hub` at the hub and nothing at the rim (with their slopes, if `clamped`), then those free at neither."""
    x = (ALONG - A * ONE) / (B - A)
    free = (x * (1.0 - x)) ** (2 if clamped else 1)
    first = 1.0 - x if not clamped else (1.0 - x) ** 2 * (1.0 + 2.0 * x)
    slope = (1.0 - x) ** 2 * x * (B - A)
    start = hub(A) * first + (hub.deriv()(A) * slope if clamped else 0.0 * ONE)
    return [start, *(free * Legendre.basis(k, [A, B]) for k in range(16))]


def least(energy):
    """The stiffness of the hub: the energy's matrix condensed to the first function."""
    return energy[0, 0] - energy[0, 1:] @ np.linalg.solve(energy[1:, 1:], energy[1:, 0])


def plate(hub, n):
    """2 U of w = f(r) cos(n phi), by Kirchhoff."""
    rows = shapes(hub, clamped=True)
    f, d, dd = (np.array([row.deriv(k)(R) if k else row(R) for row in rows]) for k in (0, 1, 2))
    radial, around, twist = dd, d / R - n * n * f / R**2, n * (d / R - f / R**2)
    grown = [one[:, None] * other[None] for one, other in ((radial, radial), (around, around), (radial, around), (twist, twist))]
    density = grown[0] + grown[1] + NU * (grown[2] + grown[2].swapaxes(0, 1)) + 2.0 * (1.0 - NU) * grown[3]
    angle = 2.0 * np.pi if n == 0 else np.pi
    return angle * 200e9 * T**3 / (12.0 * (1.0 - NU**2)) * np.sum(density * R * W, axis=-1)


def disc():
    """2 U of u_r = f(r) cos(phi), u_phi = -g(r) sin(phi), in plane stress: a hub that moves has f = g = 1."""
    one = shapes(ONE, clamped=False)
    pairs = [(one[0], one[0]), *((each, 0.0 * ONE) for each in one[1:]), *((0.0 * ONE, each) for each in one[1:])]
    f, fd, g, gd = (np.array([part(R) for part in each]) for each in zip(*((p, p.deriv(), q, q.deriv()) for p, q in pairs), strict=True))
    radial, around, shear = fd, (f - g) / R, -f / R - gd + g / R
    pairs = ((radial, radial), (around, around), (radial, around), (shear, shear))
    grown = [first[:, None] * second[None] for first, second in pairs]
    density = grown[0] + grown[1] + NU * (grown[2] + grown[2].swapaxes(0, 1)) + 0.5 * (1.0 - NU) * grown[3]
    return np.pi * 200e9 * T / (1.0 - NU**2) * np.sum(density * R * W, axis=-1)


def test_membrane_is_as_stiff_as_its_least_energy():
    found = np.diag(membrane_stiffness(Membrane("steel", 2.0 * A, 2.0 * B, T), STEEL))
    assert found[0] == pytest.approx(least(plate(ONE, 0)), rel=1e-9)
    assert found[4] == found[5] == pytest.approx(least(plate(ALONG, 1)), rel=1e-9)
    assert found[1] == found[2] == pytest.approx(least(disc()), rel=1e-9)
    shear = 200e9 / 2.6
    assert found[3] == pytest.approx(2.0 * np.pi * shear * T / np.sum(W / R**3), rel=1e-9)


def test_a_narrow_ring_is_a_leaf_all_round():
    """Of width c, far from the axis: 12 E' I / c^3 a length along x, half of it times R^2 about a diameter."""
    width, radius = 1e-4, 1.0
    found = np.diag(membrane_stiffness(Membrane("steel", 2.0 * radius - width, 2.0 * radius + width, 1e-6), STEEL))
    round_about = 2.0 * np.pi * radius * 200e9 / (1.0 - NU**2) * (1e-6 / width) ** 3
    assert found[0] == pytest.approx(round_about, rel=1e-3)
    assert found[4] == pytest.approx(0.5 * round_about, rel=1e-3)


def test_derivatives_pass_through():
    stepped = np.diag(membrane_stiffness(Membrane("steel", 0.02, 0.06, 2e-4 + 1e-24j), STEEL))
    assert stepped[0].imag / 1e-24 == pytest.approx(3.0 * stepped[0].real / 2e-4, rel=1e-12)
