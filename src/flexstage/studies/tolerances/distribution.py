"""Distributions of deviations about zero: normal, optionally truncated, and uniform."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
import scipy

from flexstage.base.number import Array

REACH = 5.0
"""Assumed reach of an untruncated normal distribution for bounds, in standard deviations."""
_LEAST = 2.0**-54


class Shape(Enum):
    """The shape of a distribution; its size is the standard deviation of a normal, the half width of a uniform one."""

    NORMAL = "normal"
    UNIFORM = "uniform"


@dataclass(frozen=True)
class Distribution:
    """A distribution about zero of `size`; a normal one is truncated at plus or minus `within`."""

    shape: Shape
    size: float
    within: float | None = None

    def quantile(self, shares: Array) -> Array:
        """Deviations at shares of the probability, the inverse of the cumulative distribution.

        >>> Distribution(Shape.UNIFORM, 2.0).quantile(np.array([0.0, 0.5, 1.0])).tolist()
        [-2.0, 0.0, 2.0]
        """
        if self.shape is Shape.UNIFORM:
            return self.size * (2.0 * shares - 1.0)
        if self.within is None:
            return self.size * scipy.special.ndtri(np.clip(shares, _LEAST, 1.0 - 2.0 * _LEAST))
        lowest = scipy.special.ndtr(-self.within / self.size)
        return np.clip(self.size * scipy.special.ndtri(lowest + shares * (1.0 - 2.0 * lowest)), -self.within, self.within)

    @property
    def deviation(self) -> float:
        """Standard deviation; of a truncated normal sigma sqrt(1 - 2 a phi(a) / (2 Phi(a) - 1)), a = within / sigma.

        >>> round(Distribution(Shape.NORMAL, 1.0, within=1.0).deviation, 4), Distribution(Shape.UNIFORM, 3.0**0.5).deviation
        (0.5396, 1.0)
        """
        if self.shape is Shape.UNIFORM:
            return float(self.size / np.sqrt(3.0))
        if self.within is None:
            return self.size
        edge = self.within / self.size
        density = np.exp(-0.5 * edge * edge) / np.sqrt(2.0 * np.pi)
        return float(self.size * np.sqrt(1.0 - 2.0 * edge * density / (2.0 * scipy.special.ndtr(edge) - 1.0)))

    @property
    def largest(self) -> float | None:
        """The largest deviation, if it is bounded.

        >>> Distribution(Shape.NORMAL, 1.0).largest is None
        True
        """
        return self.size if self.shape is Shape.UNIFORM else self.within

    def times(self, factor: float) -> Distribution:
        """The same shape, with a width multiplied by a factor.

        >>> Distribution(Shape.NORMAL, 1.0, within=2.0).times(2.0)
        Distribution(shape=<Shape.NORMAL: 'normal'>, size=2.0, within=4.0)
        """
        return Distribution(self.shape, self.size * factor, None if self.within is None else self.within * factor)


NONE = Distribution(Shape.NORMAL, 0.0)
"""No deviation."""
