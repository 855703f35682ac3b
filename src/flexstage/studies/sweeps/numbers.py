"""The numbers of the description that a study's designs differ in, where variables share them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array

_BEYOND = 1e-9
"""How much of a range is added at its ends, so that rounding leads no design out of it."""


@dataclass(frozen=True, eq=False)
class Numbers:
    """P numbers at `addresses`: each is variable `of` (P,) times `factor` (P,); shared parts before overrides of them."""

    addresses: tuple[str, ...]
    of: Array
    factor: Array

    def at(self, values: Array) -> Array:
        """The numbers (n, P) of designs with `values` (n, d) of the variables.

        >>> Numbers(("a", "b"), np.array([0, 0]), np.array([1.0, 3.0])).at(np.array([[2.0]])).tolist()
        [[2.0, 6.0]]
        """
        return values[..., self.of] * self.factor

    def ranges(self, low: Array, high: Array) -> tuple[Array, Array]:
        """Least and largest numbers (P,) for variables from `low` to `high` (d,).

        >>> low, high = Numbers(("a",), np.array([0]), np.array([-2.0])).ranges(np.array([1.0]), np.array([2.0]))
        >>> low.round(6).tolist(), high.round(6).tolist()
        ([-4.0], [-2.0])
        """
        ends = np.stack([self.at(low), self.at(high)])
        more = _BEYOND * np.ptp(ends, axis=0)
        return ends.min(axis=0) - more, ends.max(axis=0) + more
