"""Stations along a hinge profile at which beam integrals are evaluated.

A hinge is symmetric about its centre: the stations cover the half x >= 0, from the centre to the arc's end, both included, by one
Gauss-Lobatto rule on each smooth piece. On an arc the variable is the angle p stretched by p = d sinh(v), with i d the singularity of 1/h
nearest to the centre, so that thin and thick necks converge alike: integrals of 1/h ... 1/h^4 are correct to 1e-13
for thickness over radius from 1e-3 upwards, to 2e-12 at 1e-4.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Legendre, legendre

from flexstage.base.number import Array, Number
from flexstage.parts.profile import Circular, Elliptic, Filleted, Profile, Straight

_POINTS = 25


@dataclass(frozen=True, eq=False)
class Rule:
    """A composite rule on unit pieces: `weights` (m,) and `running` (m, m), the integrals from the first point to each point."""

    weights: Array
    running: Array


@dataclass(frozen=True, eq=False)
class Stations:
    """Points of the half hinge: `position` x >= 0 [m], `rate` dx/du of the rule's variable, added height `growth` w [m], all (..., m)."""

    position: Array
    rate: Array
    growth: Array
    rule: Rule

    def whole(self, values: Array) -> Array:
        """Integral over the whole hinge of an even function given at the stations (..., m) -> (...)."""
        return 2.0 * np.sum(values * self.rate * self.rule.weights, axis=-1)

    def running(self, values: Array) -> Array:
        """Integrals from the centre to each station (..., m) -> (..., m)."""
        return (self.rule.running @ (values * self.rate)[..., None])[..., 0]  # each design by itself: no bit depends on the batch


def stations(profile: Profile, thinnest: Number) -> Stations:
    """The stations of a profile whose section is `thinnest` [m] at the centre.

    >>> points = stations(Circular(1.0), 0.1)
    >>> bool(abs(points.whole(1.0 + points.growth) - (2.0 + 2.0 - np.pi / 2.0)) < 1e-14)
    True
    """
    if isinstance(profile, Circular):
        return _arc(profile.radius, profile.radius, thinnest)
    if isinstance(profile, Elliptic):
        return _arc(profile.along, profile.across, thinnest)
    if isinstance(profile, Straight):
        return _straight(0.5 * profile.length)
    return _fillet_stations(profile, thinnest)


def _straight(half: Number) -> Stations:
    u, rule = _points(), _rule(1)
    rate = np.asarray(half)[..., None] * np.ones(_POINTS)
    return Stations(rate * u, rate, np.zeros_like(rate), rule)


def _arc(along: Number, across: Number, thinnest: Number) -> Stations:
    """Arc x = a sin p, w = c (1 - cos p); the singularity is at p = i arccosh(1 + t / 2c). Nodes are complex where numbers are stepped."""
    along, across = np.asarray(along)[..., None], np.asarray(across)[..., None]
    scale = 2.0 * np.arcsinh(np.sqrt(np.asarray(thinnest)[..., None] / (4.0 * across)))
    span = np.arcsinh(0.5 * np.pi / scale)
    stretched = span * _points()
    angle = scale * np.sinh(stretched)
    rate = along * np.cos(angle) * scale * np.cosh(stretched) * span
    growth = 2.0 * across * np.sin(0.5 * angle) ** 2
    return Stations(along * np.sin(angle), rate, growth * np.ones_like(rate), _rule(1))


def _fillet_stations(profile: Filleted, thinnest: Number) -> Stations:
    straight = _straight(0.5 * profile.length - profile.radius)
    fillet = _arc(profile.radius, profile.radius, thinnest)
    start = np.asarray(0.5 * profile.length - profile.radius)[..., None]
    position = _join(straight.position, start + fillet.position)
    return Stations(position, _join(straight.rate, fillet.rate), _join(straight.growth, fillet.growth), _rule(2))


def _join(first: Array, second: Array) -> Array:
    batch = np.broadcast_shapes(first.shape[:-1], second.shape[:-1])
    return np.concatenate([np.broadcast_to(item, (*batch, item.shape[-1])) for item in (first, second)], axis=-1)


@functools.cache
def _points() -> Array:
    """Gauss-Lobatto points on [0, 1], both ends included."""
    derivative = Legendre.basis(_POINTS - 1).deriv()
    inner = np.sort(np.real(derivative.roots()))
    inner = inner - derivative(inner) / derivative.deriv()(inner)
    return np.concatenate([[0.0], 0.5 * (1.0 + inner), [1.0]])


@functools.cache
def _rule(pieces: int) -> Rule:
    """Interpolatory weights and running integrals of `pieces` unit pieces, one after the other."""
    x = 2.0 * _points() - 1.0
    integrals = legendre.legint(np.eye(_POINTS), lbnd=-1.0, axis=0)
    one = 0.5 * legendre.legvander(x, _POINTS) @ integrals @ np.linalg.inv(legendre.legvander(x, _POINTS - 1))
    weights = one[-1]
    running = np.kron(np.eye(pieces), one) + np.kron(np.tril(np.ones((pieces, pieces)), -1), np.tile(weights, (_POINTS, 1)))
    return Rule(np.tile(weights, pieces), running)
