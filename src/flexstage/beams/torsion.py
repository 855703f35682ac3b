"""Torsion of hinges with restrained warping at their ends.

A twisted section also warps along x. The rigid bodies at the ends of a hinge prevent warping. With twist phi(x) and warping u = theta(x) y
z, the strain energy U is

    2 U = integral of G J phi'^2 + G S (r phi' - theta)^2 + E C_w theta'^2 dx,    theta = 0 at both ends,

J is Saint-Venant's constant, S = I_p / k (polar second moment I_p, shear factor k), r = (b^2 - t^2) / (b^2 + t^2), C_w = b^3 t^3 / 144,
with width b and thickness t. For the shape y z, U is the exact energy of the displacement field with two changes: the factor k, and J
instead of b^3 t^3 / (3 (b^2 + t^2)).

Limits of the torsional compliance C, with the transverse compliance C_y:

- slender hinge: C = integral of dx / (G J) (Saint-Venant);
- wide hinge: C = 12 C_y / b^2 (every strip dz bends as the hinge does);
- square section: no warping.

No interpolation is needed between these limits. Stiffness errors, compared with 3-D finite elements of circular notches with rigid arc ends
(tests/elsewhere):

- t/R = 0.2: below 1 % for widths from 2 t to 10 t, 2 % at 30 t;
- t/R from 0.5 to 1: +3 to +8 %, and -6 % for a square throat.

Saint-Venant torsion is up to 25 times too soft, and C = 12 C_y / b^2 is up to 10 times too soft. The root compliance of full-height blocks
makes a wide notch up to 20 % softer, as in tension.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.quadrature import Stations
from flexstage.parts.section import Section

_LONG = 20.0
"""Decay lengths from the centre to an end above which the stations do not resolve the ends; the integral equation is solved instead."""
_TOGETHER = 32
"""Designs per batch of the solution."""


@dataclass(frozen=True, eq=False)
class Twisting:
    """Response of a hinge to a unit torque at stations (..., m): twist `rate` phi' [rad/(N m^2)], `bimoment` E C_w theta' [m].

    phi is the twist, theta the warping (see the module docstring).
    """

    rate: Array
    bimoment: Array


def free_twist(section: Section, shear: Array) -> Twisting:
    """Compute the twist rate phi' = 1 / (G J) of a part with free warping and Saint-Venant stiffness G J, e.g. of circular section.

    >>> from flexstage.parts.section import circle
    >>> bool(abs(free_twist(circle(np.ones(1), 1.0), np.ones(1)).rate[0] - 32 / np.pi) < 1e-12)
    True
    """
    rate = 1.0 / (shear * section.torsion)
    return Twisting(rate, np.zeros_like(rate))


def constrained_twist(section: Section, points: Stations, young: Array, shear: Array) -> Twisting:
    """Compute the twist of a hinge with restrained warping; moduli `young` E and `shear` G [Pa], shape (..., 1).

    Elimination of the twist rate phi' gives (E C_w theta')' - g theta + f = 0 for the warping theta. With the symbols of the module
    docstring, f = S r / (J + S r^2) and g = G S J / (J + S r^2). The integral equation theta = A (f - g theta) is solved, where the
    operator A integrates twice by the quadrature rule of the stations.

    If the section is constant and the stations resolve its end zones, theta = (f / g) (1 - cosh(kx) / cosh(kL/2)), with the length L and
    k^2 = g / (E C_w).

    >>> from flexstage.beams.quadrature import stations
    >>> from flexstage.parts.section import Rectangle
    >>> from flexstage.parts.profile import Straight
    >>> points = stations(Straight(0.1), 0.001)
    >>> section = Rectangle(np.full(25, 0.001), np.full(25, 0.01))
    >>> one = np.ones(1)
    >>> ratio = points.whole(constrained_twist(section, points, 2.6 * one, one).rate) / points.whole(free_twist(section, one).rate)
    >>> round(float(ratio), 3)  # 1 - tanh(lam) / lam, lam = (L/b) sqrt(6 / (1 + nu)) = 21.5
    0.954
    """
    if section.warping is None:
        return free_twist(section, shear)
    square_y, square_z = section.height * section.height, section.width * section.width
    skew = (square_z - square_y) / (square_z + square_y)
    stiffness = section.polar / section.shear
    whole = section.torsion + stiffness * skew * skew
    load = np.asarray(stiffness * skew / whole)
    spring = shear * stiffness * section.torsion / whole
    free, rigidity = 1.0 / (shear * whole), young * section.warping
    resolved = _is_resolved(points, rigidity, spring)
    if np.all(resolved):
        theta, bimoment = _in_closed_form(points, rigidity, spring, load)
    else:
        theta, bimoment = _at_stations(points, rigidity, spring, load)
        if np.any(resolved):  # one design at a time: the result does not depend on the batch
            closed, bending = _in_closed_form(points, rigidity, spring, load)
            theta, bimoment = np.where(resolved, closed, theta), np.where(resolved, bending, bimoment)
    return Twisting(free + load * theta, bimoment)


def _is_resolved(points: Stations, rigidity: Array, spring: Array) -> Array:
    """Whether (..., 1) the section is constant, including its complex steps, and the stations resolve its ends."""
    square = np.real(spring) / np.real(rigidity)
    if not np.any(np.all(square == square[..., :1], axis=-1)):  # cheap test first
        return np.zeros((*square.shape[:-1], 1), dtype=bool)
    wavenumber = np.sqrt(spring / rigidity)
    equal = np.all(wavenumber == wavenumber[..., :1], axis=-1)
    return np.asarray(equal & (np.real(wavenumber * points.position)[..., -1] < _LONG))[..., None]


def _in_closed_form(points: Stations, rigidity: Array, spring: Array, load: Array) -> tuple[Array, Array]:
    """theta and E C_w theta' of a constant section; theta is f / g far from the ends."""
    wavenumber, plateau = np.sqrt(spring / rigidity), load / spring
    straight, sloping = decays(points, wavenumber)
    return plateau * (1.0 - straight), -rigidity * plateau * wavenumber * sloping


def _at_stations(points: Stations, rigidity: Array, spring: Array, load: Array) -> tuple[Array, Array]:
    """theta and E C_w theta' of the equation at the stations."""
    theta = _warping(points, points.rate / rigidity, points.rate * spring, points.rate * load)
    return theta, -points.running(load - spring * theta)


def decays(points: Stations, wavenumber: Array) -> tuple[Array, Array]:
    """Compute cosh(k x) / cosh(k l) and sinh(k x) / cosh(k l) at the stations x, for a wavenumber k (..., 1); l is the last station.

    >>> from flexstage.beams.quadrature import stations
    >>> from flexstage.parts.profile import Straight
    >>> [float(each[-1]) for each in decays(stations(Straight(2.0), 0.1), np.full(1, 1000.0))]
    [1.0, 1.0]
    """
    half = points.position[..., -1:]
    near, far = np.exp(wavenumber * (points.position - half)), np.exp(-wavenumber * (points.position + half))
    whole = 1.0 + np.exp(-2.0 * wavenumber * half)
    return (near + far) / whole, (near - far) / whole


def _warping(points: Stations, *numbers: Array) -> Array:
    """theta at the stations (..., m), of 1 / (E C_w), g and f, each times dx/du; in batches whose matrices fit the cache.

    Complex steps along a first axis, at equal real parts, share the matrices of the real parts.
    """
    numbers = np.broadcast_arrays(*numbers)
    shape: tuple[int, ...] = numbers[0].shape
    shared = numbers[0].ndim > 2 and all(np.array_equal(np.real(each), np.broadcast_to(np.real(each[:1]), shape)) for each in numbers)
    flat = [each.reshape(shape[0] if shared else 1, -1, shape[-1]) for each in numbers]
    blocks = [slice(start, start + _TOGETHER) for start in range(0, flat[0].shape[1], _TOGETHER)]
    solved_blocks = [_theta(points, *(np.moveaxis(each[:, block], 0, -1) for each in flat)) for block in blocks]
    return np.moveaxis(np.concatenate(solved_blocks), -1, 0).reshape(shape)


def _theta(points: Stations, *numbers: Array) -> Array:
    """theta for numbers (b, m, n) with equal real parts along n; complex steps pass through the solution."""
    out, running = points.rule.weights - points.rule.running, points.rule.running
    softness, spring, load = (np.real(each[..., :1]) for each in numbers)
    integral = out @ (softness * running)
    system = np.eye(len(out)) + integral * spring.mT
    theta = np.linalg.solve(system, integral @ load)
    if not any(map(np.iscomplexobj, numbers)):
        return np.broadcast_to(theta, numbers[0].shape)
    softer, stiffer, loaded = map(np.imag, numbers)
    right = out @ (softer * (running @ (load - spring * theta)) + softness * (running @ (loaded - stiffer * theta)))
    return theta + 1j * np.linalg.solve(system, right)
