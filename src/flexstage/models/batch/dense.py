"""One design after another by dense matrices: what stages take that are small or not free six by six, and designs that iteration leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.models.linear.eigen import solve

_SINGULAR = 1e-11
"""Least eigenvalue of K scaled to a unit diagonal; below it `models.lumped` finds a motion without stiffness."""


@dataclass(frozen=True, eq=False)
class Whole:
    """All modes of one design: `values` lambda (k,), `shapes` (n, k), `share` of the platform (k,); empty where K is singular."""

    values: Array
    shapes: Array
    share: Array


def whole(stiffness: Array, inertia: Array, platform: Array) -> Whole:
    """Every mode of one design; `platform` (n, n) is the platform's own inertia.

    >>> found = whole(np.diag([4.0, 1.0]), np.eye(2), np.diag([1.0, 0.0]))
    >>> found.values.tolist(), found.share.tolist()
    ([1.0, 4.0], [0.0, 1.0])
    """
    size = len(stiffness)
    none = Whole(np.zeros(0), np.zeros((size, 0)), np.zeros(0))
    diagonal = np.diag(stiffness)
    if not (np.isfinite(stiffness).all() and np.isfinite(inertia).all()) or np.min(diagonal) <= 0.0:
        return none
    root = np.sqrt(diagonal)
    if _is_singular(stiffness / root / root[:, None]):
        return none
    solved = solve(stiffness, inertia, np.ones(size))
    return Whole(solved.values, solved.shapes, np.sum(solved.shapes * (platform @ solved.shapes), axis=0))


def _is_singular(scaled: Array) -> bool:
    try:
        if np.min(np.diag(np.linalg.cholesky(scaled))) ** 2 > _SINGULAR:
            return False
    except np.linalg.LinAlgError:
        pass
    return bool(np.linalg.eigvalsh(scaled)[0] < _SINGULAR)
