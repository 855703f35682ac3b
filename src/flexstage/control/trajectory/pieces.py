"""Piecewise polynomial motions in time."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.base.number import Array


@dataclass(frozen=True, eq=False)
class Pieces:
    """Piecewise polynomial in time [s], a column for each coordinate; constant before the first and after the last knot.

    `coefficients` (k, m, c) have the highest power first; time counts from the start of each piece. `knots` (m + 1,) are the times [s]
    at which pieces start or end.
    """

    coefficients: Array
    knots: Array

    @property
    def duration(self) -> float:
        """Time of the last knot [s]."""
        return float(self.knots[-1])

    def at(self, times: Array, order: int = 0) -> Array:
        """Compute values (n, c) at `times` (n,) [s], or time derivatives of the specified `order`."""
        whole = scipy.interpolate.PPoly(self.coefficients, self.knots)
        return np.asarray(whole(np.clip(times, self.knots[0], self.knots[-1]), order))


def join(parts: Iterable[tuple[float, Array]]) -> Pieces:
    """Concatenate pieces (duration [s], coefficients (6, c)), each relative to its own start; pieces of zero duration are omitted.

    >>> forth = np.zeros((6, 1)); forth[1] = 2.0
    >>> join([(0.5, forth), (0.5, rest(np.array([1.0])))]).at(np.array([0.25, 0.75, 9.0])).ravel().tolist()
    [0.5, 1.0, 1.0]
    """
    kept = [(time, coefficients) for time, coefficients in parts if time > 0.0]
    knots = np.concatenate([[0.0], np.cumsum([time for time, _ in kept])])
    return Pieces(np.stack([each[::-1] for _, each in kept], axis=1), knots)


def rest(position: Array) -> Array:
    """Return the coefficients (6, c) of a constant position.

    >>> rest(np.array([3.0]))[:2].tolist()
    [[3.0], [0.0]]
    """
    result = np.zeros((6, len(position)))
    result[0] = position
    return result


def smooth(start: Array, end: Array, time: float) -> Array:
    """Compute coefficients (6, c) of the quintic rest-to-rest move: start + (end - start)(10 s^3 - 15 s^4 + 6 s^5), s = t/`time` [s].

    For a distance d, the largest speed is (15/8) d/`time`, the largest acceleration is (10/3^(1/2)) d/`time`^2.

    >>> move = join([(2.0, smooth(np.array([0.0]), np.array([1.0]), 2.0))])
    >>> move.at(np.array([1.0, 2.0])).ravel().tolist()
    [0.5, 1.0]
    """
    result = rest(start)
    for power, factor in ((3, 10.0), (4, -15.0), (5, 6.0)):
        result[power] = factor * (end - start) / time**power
    return result


def smooth_time(distance: float, speed: float, acceleration: float) -> float:
    """Compute the minimum time [s] of a `smooth` move over a `distance`, with limited `speed` and `acceleration`.

    >>> smooth_time(1.0, 15.0 / 8.0, 100.0)
    1.0
    """
    return max(15.0 / 8.0 * distance / speed, np.sqrt(10.0 / 3.0**0.5 * distance / acceleration))
