"""Numbers that differ between a study's designs, as linear functions of the variables."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array


@dataclass(frozen=True, eq=False)
class Numbers:
    """P numbers of the design at `addresses`. The values are `nominal` (P,) plus the product of the variables (d,) and `matrix` (d, P).

    Numbers of shared parts precede the numbers of single instances that override them.
    """

    addresses: tuple[str, ...]
    nominal: Array
    matrix: Array

    def at(self, values: Array) -> Array:
        """Compute the numbers (n, P) of designs with `values` (n, d) of the variables.

        >>> Numbers(("a", "b"), np.array([1.0, 0.0]), np.array([[1.0, 3.0]])).at(np.array([[2.0]])).tolist()
        [[3.0, 6.0]]
        """
        return self.nominal + values @ self.matrix

    def ranges(self, low: Array, high: Array) -> tuple[Array, Array]:
        """Compute lower and upper bounds (P,) of the numbers for independent variables from `low` to `high` (d,).

        >>> low, high = Numbers(("a",), np.array([5.0]), np.array([[-2.0]])).ranges(np.array([-1.0]), np.array([2.0]))
        >>> low.tolist(), high.tolist()
        ([1.0], [9.0])
        """
        reach = np.maximum(np.abs(low), np.abs(high)) @ np.abs(self.matrix)
        return self.nominal - reach, self.nominal + reach
