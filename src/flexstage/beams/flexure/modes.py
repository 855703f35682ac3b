"""Polynomials along and across a flexure of unit length and width, Gauss rules, and projections that are exact with these rules."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Legendre, legendre

from flexstage.base.number import Array
from flexstage.spatial.rotation import GAUSS_THREE

FINE = 200
"""Number of Gauss points for the integrals of a flexure law."""


@dataclass(frozen=True, eq=False)
class Rule:
    """Gauss rule on [0, 1]: `points` (n,), `weights` (n,), and `running` (n, n), the integrals of the interpolant from 0 to each point.

    `knots` (n + 2,) are 0, the points and 1. `inner` (3 (n + 1),) are three Gauss points in each interval between knots. `ends` (2, n) maps
    the values at the points to the interpolated values at 0 and 1.
    """

    points: Array
    weights: Array
    running: Array
    knots: Array
    inner: Array
    ends: Array

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.points)


@functools.cache
def gauss(size: int) -> Rule:
    """Return the Gauss rule of `size` points.

    >>> rule = gauss(4)
    >>> bool(np.allclose(rule.running @ rule.points**3, rule.points**4 / 4))
    True
    """
    nodes, weights = legendre.leggauss(size)
    points = 0.5 * (nodes + 1.0)
    to_coefficients = np.linalg.inv(polynomials(size, points).T)
    antiderivatives = np.array([legendre.legval(nodes, legendre.legint(row, lbnd=-1)) for row in np.eye(size)])
    running = 0.5 * antiderivatives.T @ to_coefficients
    knots = np.concatenate([[0.0], points, [1.0]])
    inner = (knots[:-1, None] + np.diff(knots)[:, None] * GAUSS_THREE).ravel()
    ends = polynomials(size, np.array([0.0, 1.0])).T @ to_coefficients
    return Rule(points, 0.5 * weights, running, knots, inner, ends)


def polynomials(count: int, places: Array) -> Array:
    """Evaluate the Legendre polynomials P_k(2 s - 1), k < `count`, at `places` s (p,); shape (count, p).

    >>> polynomials(2, np.array([0.0, 1.0])).tolist()
    [[1.0, 1.0], [-1.0, 1.0]]
    """
    return legendre.legvander(2.0 * np.asarray(places) - 1.0, count - 1).T


@functools.cache
def clamped(count: int, folds: int) -> tuple[Array, Array, Array]:
    """Evaluate (1 - u^2)^n P_k(u), k < `count`, n = `folds`, u = 2 s - 1, and two derivatives with respect to s at the `FINE` points.

    >>> clamped(3, 1)[0].shape
    (3, 200)
    """
    clamp = Legendre([2.0 / 3.0, 0.0, -2.0 / 3.0], domain=[0.0, 1.0]) ** folds
    terms = [clamp * Legendre.basis(k, domain=[0.0, 1.0]) for k in range(count)]
    value, slope, curve = (np.array([term.deriv(order)(gauss(FINE).points) for term in terms]) for order in range(3))
    return value, slope, curve


def slopes(count: int, places: Array) -> Array:
    """Evaluate the derivatives of the `polynomials` with respect to s at `places` s (p,); shape (count, p).

    >>> slopes(2, np.array([0.5])).ravel().tolist()
    [0.0, 2.0]
    """
    return np.array([2.0 * legendre.legval(2.0 * np.asarray(places) - 1.0, legendre.legder(row)) for row in np.eye(count)])


@dataclass(frozen=True, eq=False)
class Across:
    """Integrals, across the width b = 1, of the shapes phi_j = P_j(2 z) / 12 (Legendre polynomials P_j) and their derivatives.

    The integrands are phi phi (`plain`), phi' phi' (`sloped`), phi'' phi'' (`curved`), phi phi'' (`mixed`), z phi'' (`curling`) and phi'
    (`turning`).
    """

    plain: Array
    sloped: Array
    curved: Array
    mixed: Array
    curling: Array
    turning: Array


@functools.cache
def across(degrees: tuple[int, ...]) -> Across:
    """Compute the integrals across the width for shapes of these polynomial `degrees`.

    >>> across((2,)).curved.round(12).tolist()
    [[1.0]]
    """
    nodes, weights = legendre.leggauss(max(degrees) + 1)
    half = 0.5 * weights
    shapes = [Legendre.basis(degree, domain=[-0.5, 0.5]) / 12.0 for degree in degrees]
    value, slope, curve = (np.array([shape.deriv(order)(0.5 * nodes) for shape in shapes]) for order in (0, 1, 2))
    plain, sloped, curved, mixed = (one * half @ other.T for one, other in ((value, value), (slope, slope), (curve, curve), (value, curve)))
    return Across(plain, sloped, curved, mixed, (curve * half) @ (0.5 * nodes), slope @ half)


def project(values: Array, places: Array, weights: Array, size: int) -> Array:
    """Project functions on the first `size` Legendre polynomials P_k by least squares; returns coefficients (..., size).

    `values` (..., p) are the functions at the integration points `places` (p,), which have the `weights` (p,).

    >>> rule = gauss(5)
    >>> project(rule.points**2, rule.points, rule.weights, 3).round(12).tolist()
    [0.333333333333, 0.5, 0.166666666667]
    """
    return values @ (polynomials(size, places) * weights).T * (2.0 * np.arange(size) + 1.0)
