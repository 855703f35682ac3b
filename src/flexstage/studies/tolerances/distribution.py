"""Distributions of deviations: normal, optionally truncated, and uniform. The distribution of an asymmetric tolerance has an offset."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
import scipy

from flexstage.base.number import Array

REACH = 5.0
"""Largest assumed deviation of an untruncated normal distribution in checks of bounds [standard deviations]."""
_LEAST = 2.0**-54


class Shape(Enum):
    """Shape of a distribution. The size of a distribution is the standard deviation (normal) or the half width (uniform)."""

    NORMAL = "normal"
    UNIFORM = "uniform"


@dataclass(frozen=True)
class Distribution:
    """A distribution of `size` about its mean `offset`. A normal distribution may be truncated at `offset` plus or minus `within`."""

    shape: Shape
    size: float
    within: float | None = None
    offset: float = 0.0

    def quantile(self, shares: Array) -> Array:
        """Compute the deviations at the cumulative probabilities `shares`, 0 to 1, by the inverse of the cumulative distribution.

        >>> Distribution(Shape.UNIFORM, 2.0, offset=1.0).quantile(np.array([0.0, 0.5, 1.0])).tolist()
        [-1.0, 1.0, 3.0]
        """
        if self.shape is Shape.UNIFORM:
            return self.offset + self.size * (2.0 * shares - 1.0)
        if self.within is None:
            return self.offset + self.size * scipy.special.ndtri(np.clip(shares, _LEAST, 1.0 - 2.0 * _LEAST))
        lowest = scipy.special.ndtr(-self.within / self.size)
        return self.offset + np.clip(self.size * scipy.special.ndtri(lowest + shares * (1.0 - 2.0 * lowest)), -self.within, self.within)

    @property
    def deviation(self) -> float:
        """Standard deviation, also of a truncated normal distribution.

        With sigma = `size` and a = `within` / sigma, the standard deviation after truncation is sigma sqrt(1 - 2 a phi(a) / (2 Phi(a) -
        1)). Here phi and Phi are the density and the cumulative distribution of the standard normal distribution.

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
    def ends(self) -> tuple[float, float] | None:
        """The smallest and largest deviation, if bounded.

        >>> Distribution(Shape.NORMAL, 1.0).ends is None, Distribution(Shape.UNIFORM, 3.0, offset=2.0).ends
        (True, (-1.0, 5.0))
        """
        half = self.size if self.shape is Shape.UNIFORM else self.within
        return None if half is None else (self.offset - half, self.offset + half)

    def times(self, factor: float) -> Distribution:
        """Return the distribution with all deviations multiplied by a factor.

        >>> Distribution(Shape.NORMAL, 1.0, within=2.0).times(2.0)
        Distribution(shape=<Shape.NORMAL: 'normal'>, size=2.0, within=4.0, offset=0.0)
        """
        return Distribution(self.shape, self.size * factor, None if self.within is None else self.within * factor, self.offset * factor)


NONE = Distribution(Shape.NORMAL, 0.0)
"""No deviation."""
