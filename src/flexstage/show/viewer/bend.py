"""Bending of a link along its length, from the motions of its two bodies, with exact position and slope at both ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.parts.part import Part, inner
from flexstage.parts.profile import single
from flexstage.parts.shape import Shaped

COLUMNS = 5
_INTERVALS = 400


@dataclass(frozen=True, eq=False)
class Bend:
    """Shape functions of a straight part with its first end fixed, for an offset and a rotation of its second end.

    The deflection at the fraction s of the length L, 0 to 1, is v(s) = offset N(s) + rotation L M(s). N, M and their slopes are zero at the
    ends, except N(1) = M'(1) = 1. The columns of `values` (n, 5) contain s (which interpolates elongation and twist), N, M, N' and M' at
    the fractions `shares` (n,).
    """

    shares: Array
    values: Array

    def at(self, shares: Array) -> Array:
        """Interpolate the values (k, 5) at fractions (k,) of the length."""
        return interpolate(shares, self.shares, self.values)


def interpolate(shares: Array, places: Array, values: Array) -> Array:
    """Interpolate rows of values (n, k), known at n places, linearly at other fractions of a length.

    >>> interpolate(np.array([0.5]), np.array([0.0, 1.0]), np.array([[0.0, 2.0], [1.0, 4.0]])).tolist()
    [[0.5, 3.0]]
    """
    return np.stack([np.interp(shares, places, column) for column in values.T], axis=-1)


def bend_of(part: Part | None) -> Bend:
    """Compute the shape functions of a part as a beam with its cross-sections and with loads at its ends only.

    Curvature is proportional to (a + b s) / I(s), where I is the least second moment of area of the section. The constants a and b follow
    from the conditions at the ends. For a uniform part, the functions are cubic Hermite polynomials. Shear is neglected. A part without a
    shape is treated as uniform.

    >>> from flexstage.parts.leaf import Leaf
    >>> bend_of(Leaf("steel", 0.02, 0.001, 0.01)).at(np.array([0.5, 1.0])).round(4).tolist()
    [[0.5, 0.5, -0.125, 1.5, -0.25], [1.0, 1.0, 0.0, 0.0, 1.0]]
    """
    own = None if part is None else inner(part)
    shares = np.linspace(0.0, 1.0, _INTERVALS + 1)
    return _bend(shares, _flexibility(own, shares) if isinstance(own, Shaped) and not own.is_prismatic else np.ones(_INTERVALS))


def _flexibility(part: Shaped, shares: Array) -> Array:
    """1 / I in the middle of each interval of shares (n + 1,), divided by the largest; sizes are interpolated linearly between stations."""
    places = (0.5 * (shares[1:] + shares[:-1]) - 0.5) * single(part.span)
    moment = part.section_at(places).least_inertia
    return np.min(moment) / moment


def _bend(shares: Array, flexibility: Array) -> Bend:
    """The bend of a beam with this flexibility (n,) between shares (n + 1,)."""
    step = np.diff(shares)
    curvatures = np.stack([flexibility, flexibility * 0.5 * (shares[1:] + shares[:-1])])
    slopes = _sum(curvatures * step)
    deflections = _sum(slopes[:, :-1] * step + 0.5 * curvatures * step**2)
    ends = np.stack([deflections[:, -1], slopes[:, -1]])
    by_offset, by_turn = np.linalg.solve(ends, np.eye(2)).T
    rows = [shares, by_offset @ deflections, by_turn @ deflections, by_offset @ slopes, by_turn @ slopes]
    values = np.stack(rows, axis=-1)
    values[0], values[-1] = [0.0] * COLUMNS, [1.0, 1.0, 0.0, 0.0, 1.0]  # exact, without rounding errors of the sums
    return Bend(shares, values)


def _sum(steps: Array) -> Array:
    return np.concatenate([np.zeros((len(steps), 1)), np.cumsum(steps, axis=-1)], axis=-1)
