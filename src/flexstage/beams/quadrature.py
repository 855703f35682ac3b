"""Quadrature stations of beam integrals along a hinge profile.

A hinge is symmetric about its centre. The stations cover the half x >= 0, from the centre to the arc's end, both included, with one
Gauss-Lobatto rule on each smooth piece. On an arc, the angle p is stretched by p = d sinh(v), where i d is the singularity of 1/h nearest
to the centre, and h the thickness. Convergence is then equal for thin and thick necks. Integrals of 1/h to 1/h^4 are correct to 1e-13 for
thickness over radius from 1e-3 upwards, and to 2e-12 at 1e-4.

Parabolas and hyperbolas use the same stretching. On straight flanks, 1/h is an exponential function of the integration variable. Power
profiles have three pieces for any exponent (error 1e-9 at 16). Each piece of a table has its own rule, with fewer points.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import Legendre, legendre

from flexstage.base.number import Array, Number, with_step
from flexstage.parts.profile import Circular, Elliptic, Filleted, FreeForm, Hyperbolic, Parabolic, Power, Profile, Straight, Vee

_POINTS = 25
_FEW_POINTS = 15
"""Points per piece of a table."""


@dataclass(frozen=True, eq=False)
class Rule:
    """Composite quadrature rule for pieces of unit length: `weights` (m,), and `running` (m, m) for integrals from the first point."""

    weights: Array
    running: Array


@dataclass(frozen=True, eq=False)
class Stations:
    """Points of half a hinge: `position` x >= 0 [m], `rate` dx/du with the rule's variable u, height `growth` w [m] of the cut.

    All arrays have the shape (..., m).
    """

    position: Array
    rate: Array
    growth: Array
    rule: Rule

    def whole(self, values: Array) -> Array:
        """Integrate an even function, given at the stations (..., m), over the whole hinge."""
        return 2.0 * np.sum(values * self.rate * self.rule.weights, axis=-1)

    def running(self, values: Array) -> Array:
        """Integrate a function (..., m) from the centre to each station."""
        return self.runnings(values)[0]

    def runnings(self, *values: Array) -> tuple[Array, ...]:
        """Apply `running` to several functions."""
        columns = np.stack(np.broadcast_arrays(*values, self.rate)[:-1], axis=-1) * self.rate[..., None]
        return tuple(np.moveaxis(through(self.rule.running, columns), -1, 0))  # by design: independent of the batch


def through(rule: Array, values: Array) -> Array:
    """Multiply a real matrix (k, m) by values (..., m, n); real and imaginary parts are multiplied separately.

    >>> through(np.array([[1.0, 2.0]]), np.array([[1.0], [1.0j]])).tolist()
    [[(1+2j)]]
    """
    if not np.iscomplexobj(values):
        return rule @ values
    both = np.ascontiguousarray(values).view(float)
    return (rule @ both).view(complex)


def stations(profile: Profile, thinnest: Number) -> Stations:
    """Build the stations of a profile; the section has the thickness `thinnest` [m] at the centre.

    >>> points = stations(Circular(1.0), 0.1)
    >>> bool(abs(points.whole(1.0 + points.growth) - (2.0 + 2.0 - np.pi / 2.0)) < 1e-14)
    True
    """
    return _KINDS[type(profile)](profile, thinnest)


def _straight(half: Number) -> Stations:
    u, rule = _points(), _rule(1)
    rate = np.asarray(half)[..., None] * np.ones(_POINTS)
    return Stations(rate * u, rate, np.zeros_like(rate), rule)


def _arc(along: Number, across: Number, thinnest: Number, last: Number = 0.5 * np.pi) -> Stations:
    """Arc x = a sin p, w = c (1 - cos p) up to p = `last`.

    The singularity is at p = i arccosh(1 + t / 2c). Nodes are complex under a complex step.
    """
    along, across = np.asarray(along)[..., None], np.asarray(across)[..., None]
    scale = 2.0 * np.arcsinh(np.sqrt(np.asarray(thinnest)[..., None] / (4.0 * across)))
    span = np.arcsinh(np.asarray(last)[..., None] / scale)
    stretched = span * _points()
    grown, slope = np.sinh(np.real(stretched)), np.cosh(np.real(stretched))
    angle = scale * with_step(grown, slope, stretched)
    sine, cosine = np.sin(np.real(angle)), np.cos(np.real(angle))
    rate = along * with_step(cosine, -sine, angle) * scale * with_step(slope, grown, stretched) * span
    growth = across * with_step(2.0 * np.sin(0.5 * np.real(angle)) ** 2, sine, angle)
    return Stations(along * with_step(sine, cosine, angle), rate, growth * np.ones_like(rate), _rule(1))


def _fillet_stations(profile: Filleted, thinnest: Number) -> Stations:
    straight = _straight(0.5 * profile.length - profile.radius)
    return in_series([straight, _arc(profile.radius, profile.radius, thinnest)], [0.0, 0.5 * profile.length - profile.radius])


def _vee_stations(profile: Vee, thinnest: Number) -> Stations:
    """An arc, then a flank on which the thickness grows by equal factors: 1/h is an exponential there."""
    slope = np.tan(profile.slope)
    start = 2.0 * profile.radius * np.sin(0.5 * profile.slope) ** 2
    run = 0.5 * profile.length - profile.tip
    double = (thinnest + 2.0 * start) / (2.0 * slope)
    double, run, slope, start = (np.asarray(each)[..., None] for each in (double, run, slope, start))
    log = np.log1p(run / double)
    along = double * np.expm1(log * _points())
    flank = Stations(along, (double + along) * log, start + slope * along, _rule(1))
    return in_series([_arc(profile.radius, profile.radius, thinnest, profile.slope), flank], [0.0, profile.tip])


def _parabola(profile: Parabolic, thinnest: Number) -> Stations:
    """x = a s, s = d sinh v, d = (t / 2c)^1/2: the thickness is twice the minimum at s = d."""
    along, across = np.asarray(profile.along)[..., None], np.asarray(profile.across)[..., None]
    scale = np.sqrt(np.asarray(thinnest)[..., None] / (2.0 * across))
    span = np.arcsinh(1.0 / scale)
    share = scale * np.sinh(span * _points())
    rate = along * scale * np.cosh(span * _points()) * span
    return Stations(along * share, rate, across * share * share * np.ones_like(rate), _rule(1))


def _hyperbola(profile: Hyperbolic, thinnest: Number) -> Stations:
    """x = a/k sinh p, w = q (cosh p - 1), k^2 the steepness, p = d sinh v: an arc with an imaginary angle; two pieces if sharp."""
    across, steep = np.asarray(profile.semi_axis)[..., None], np.sqrt(np.asarray(profile.steepness))[..., None]
    along = np.asarray(profile.along)[..., None] / steep
    scale = 2.0 * np.arctan(np.sqrt(np.asarray(thinnest)[..., None] / (4.0 * across)))
    span = np.arcsinh(np.arcsinh(steep) / scale)
    stretched = 0.5 * span * np.concatenate([_points(), 1.0 + _points()])
    angle = scale * np.sinh(stretched)
    rate = along * np.cosh(angle) * scale * np.cosh(stretched) * 0.5 * span
    growth = 2.0 * across * np.sinh(0.5 * angle) ** 2
    return Stations(along * np.sinh(angle), rate, growth * np.ones_like(rate), _rule(2))


def _power(profile: Power, thinnest: Number) -> Stations:
    """For non-integer powers: up to half of the onset of the power (cubic spacing), up to the onset, then x in equal factors."""
    along, across, exponent = (np.asarray(each)[..., None] for each in (profile.along, profile.across, profile.exponent))
    least = np.asarray(thinnest)[..., None]
    double = (least / (least + 2.0 * across)) ** (1.0 / exponent)
    u, one = _points(), np.ones(_POINTS)
    log = -np.log(double)
    far = double * np.exp(log * u)
    share = np.concatenate(np.broadcast_arrays(0.5 * double * u**3, 0.5 * double * (1.0 + u), far), axis=-1)
    rate = np.concatenate(np.broadcast_arrays(1.5 * double * u * u, 0.5 * double * one, far * log), axis=-1)
    return Stations(along * share, along * rate, across * _raise(share, exponent) * np.ones_like(rate), _rule(3))


def _raise(share: Array, exponent: Array) -> Array:
    """share^exponent, zero at the centre, where the logarithm does not exist."""
    inside = np.real(share) > 0.0
    return np.where(inside, np.exp(exponent * np.log(np.where(inside, share, 1.0))), 0.0)


def _table(profile: FreeForm, thinnest: Number) -> Stations:
    """Treat each piece of a table separately, with points clustered towards its thinner end."""
    pieces, starts = zip(*((_piece(step, cubic, thinnest), start) for start, step, cubic in profile.pieces()), strict=True)
    return in_series(pieces, starts)


def _piece(step: Number, cubic: Sequence[Number], thinnest: Number) -> Stations:
    """A cubic of the fraction s of its length, s = d sinh v from the thinner end; d is near the fraction at which the thickness doubles."""
    step, least, *coefficients = (np.asarray(each)[..., None] for each in (step, thinnest, *cubic))
    low, first, second, third = coefficients
    rise, slope = first + second + third, first + 2.0 * second + 3.0 * third
    up = np.real(rise) >= 0.0
    thin, begin, rise = least + 2.0 * np.where(up, low, low + rise), np.where(up, first, -slope), np.where(up, rise, -rise)
    scale = thin / (begin + np.sqrt(begin * begin + 2.0 * thin * rise + thin * thin))
    span, points = np.arcsinh(1.0 / scale), _points(_FEW_POINTS)
    stretched = span * np.where(up, points, 1.0 - points)
    from_thin = scale * np.sinh(stretched)
    share = np.where(up, from_thin, 1.0 - from_thin)
    growth = low + share * (first + share * (second + share * third))
    return Stations(step * share, step * scale * span * np.cosh(stretched), growth, _rule(1, _FEW_POINTS))


def in_series(pieces: Sequence[Stations], starts: Sequence[Number]) -> Stations:
    """Join pieces in series at their start positions [m]. The rules of all pieces have the same number of points."""
    positions = [np.asarray(start)[..., None] + piece.position for start, piece in zip(starts, pieces, strict=True)]
    columns = (positions, [piece.rate for piece in pieces], [piece.growth for piece in pieces])
    position, rate, growth = (_concatenate(column) for column in columns)
    return Stations(position, rate, growth, _rule(len(pieces), len(pieces[0].rule.weights)))


def _concatenate(pieces: Sequence[Array]) -> Array:
    batch = np.broadcast_shapes(*(piece.shape[:-1] for piece in pieces))
    return np.concatenate([np.broadcast_to(piece, (*batch, piece.shape[-1])) for piece in pieces], axis=-1)


_KINDS: Mapping[type, Callable[[Any, Number], Stations]] = {
    Circular: lambda profile, thinnest: _arc(profile.radius, profile.radius, thinnest),
    Elliptic: lambda profile, thinnest: _arc(profile.along, profile.across, thinnest),
    Filleted: _fillet_stations,
    Straight: lambda profile, _: _straight(0.5 * profile.length),
    Parabolic: _parabola,
    Hyperbolic: _hyperbola,
    Power: _power,
    Vee: _vee_stations,
    FreeForm: _table,
}


@functools.cache
def _points(count: int = _POINTS) -> Array:
    """Gauss-Lobatto points on [0, 1], both ends included."""
    derivative = Legendre.basis(count - 1).deriv()
    inner = np.sort(np.real(derivative.roots()))
    inner = inner - derivative(inner) / derivative.deriv()(inner)
    return np.concatenate([[0.0], 0.5 * (1.0 + inner), [1.0]])


@functools.cache
def _rule(pieces: int, count: int = _POINTS) -> Rule:
    """Interpolatory weights and running integrals of `pieces` consecutive unit pieces of `count` points."""
    x = 2.0 * _points(count) - 1.0
    integrals = legendre.legint(np.eye(count), lbnd=-1.0, axis=0)
    one = 0.5 * legendre.legvander(x, count) @ integrals @ np.linalg.inv(legendre.legvander(x, count - 1))
    weights = one[-1]
    running = np.kron(np.eye(pieces), one) + np.kron(np.tril(np.ones((pieces, pieces)), -1), np.tile(weights, (count, 1)))
    return Rule(np.tile(weights, pieces), running)
