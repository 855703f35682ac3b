"""Who goes with whom: the assignment of rows to columns of least cost, without what else `scipy.optimize` imports."""

from __future__ import annotations

from typing import Any

from flexstage.base.binding import binding
from flexstage.base.number import Array


def assignment(cost: Array) -> tuple[Array, Array]:
    """Rows, ascending, and their columns with the least sum of `cost` (m, n), min(m, n) of each; every row and column once at most.

    `scipy.optimize.linear_sum_assignment` itself (Crouse 2016). Raises `ValueError` for costs that are no numbers.

    >>> import numpy as np
    >>> [each.tolist() for each in assignment(np.array([[1.0, 0.0], [0.0, 5.0]]))]
    [[0, 1], [1, 0]]
    """
    found: Any = binding("scipy.optimize._lsap", "scipy.optimize").linear_sum_assignment(cost)
    return found
