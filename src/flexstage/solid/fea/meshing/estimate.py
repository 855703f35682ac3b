"""Error estimate of finite elements from a sequence of orders and meshes, and the stopping criterion."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.number import Array

_MOST = 0.8
"""Largest ratio of successive changes that the estimate uses."""


@dataclass(frozen=True)
class Accuracy(CheckedFields):
    """Requirements of an adaptive solve.

    `error` is the required relative error, `freedoms` the maximum number of DOFs. On the first mesh, the element order rises from the first
    to the second of `orders`. The following meshes have the second order; from each mesh to the next, the element sizes are multiplied by
    `shrink`. `meshes` is the maximum number of meshes.
    """

    error: float = 0.01
    freedoms: int = 200_000
    orders: tuple[int, int] = (2, 5)
    shrink: float = 0.6
    meshes: int = 3


def change(first: Array, second: Array) -> float:
    """Compute the largest relative change of a compliance C (6, 6); the change of entry ij is divided by sqrt(C_ii C_jj) of the second C.

    >>> change(np.diag([1.0, 2.0]), np.diag([1.0, 2.02])).__round__(4)
    0.0099
    """
    scale = np.sqrt(np.abs(np.diag(second)))
    return float(np.max(np.abs(second - first) / np.outer(scale, scale)))


def remaining(changes: Iterable[float]) -> float:
    """Estimate the error of the last of several results from the `changes` d_1, ..., d_n between the results: max(1, r / (1 - r)) d_n.

    Here r is the ratio d_n / d_(n-1) of the last two changes, at most 0.8. For slow convergence, the estimate is the sum of a geometric
    series; for fast convergence, it is the last change, an overestimate. The estimate is not a bound; for a single result, it is infinite.

    >>> remaining([0.4, 0.1]), round(remaining([0.4, 0.3]), 6), round(remaining([0.4, 0.4]), 6), remaining([0.4]), remaining([])
    (0.1, 0.9, 1.6, 0.4, inf)
    """
    known = list(changes)
    if not known:
        return float("inf")
    if len(known) == 1 or known[-2] <= 0.0:
        return known[-1]
    ratio = min(known[-1] / known[-2], _MOST)
    return known[-1] * max(1.0, ratio / (1.0 - ratio))
