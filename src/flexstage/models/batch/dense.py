"""One design after another by dense matrices: what stages take that are small or not free six by six, and designs that iteration leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.choice import groups, participation
from flexstage.models.linear.eigen import cholesky, solve

_SINGULAR = 1e-11
"""Least eigenvalue of K scaled to a unit diagonal; below it `models.lumped` finds a motion without stiffness."""


@dataclass(frozen=True, eq=False)
class Whole:
    """All modes of one design: `values` lambda (k,), `shapes` (n, k), `share` of the platform (k,); empty where K is singular.

    `parts` (6, k) is their participation in the platform's compliance. Of repeated modes those come first that have most of it.
    """

    values: Array
    shapes: Array
    share: Array
    parts: Array


def whole(stiffness: Array, inertia: Array, platform: Array, rows: Array, cluster: float) -> Whole:
    """Every mode of one design; `platform` (n, n) is the platform's inertia, `rows` (6, n) its twist, `cluster` the gap of repeated modes.

    >>> found = whole(np.diag([4.0, 1.0]), np.eye(2), np.diag([1.0, 0.0]), np.eye(6, 2), 1e-6)
    >>> found.values.tolist(), found.share.tolist()
    ([1.0, 4.0], [0.0, 1.0])
    """
    size = len(stiffness)
    none = Whole(np.zeros(0), np.zeros((size, 0)), np.zeros(0), np.zeros((6, 0)))
    diagonal = np.diag(stiffness)
    if not (np.isfinite(stiffness).all() and np.isfinite(inertia).all()) or np.min(diagonal) <= 0.0:
        return none
    root = np.sqrt(diagonal)
    if _is_singular(stiffness / root / root[:, None]):
        return none
    solved = solve(stiffness, inertia, np.ones(size))
    parts, shapes = participation(np.linalg.solve(cholesky(stiffness), rows.T), rows @ solved.shapes, solved.values), solved.shapes.copy()
    group = groups(np.sqrt(solved.values)[None], cluster)[0]
    for number in np.flatnonzero(np.bincount(group) > 1):
        own = group == number
        turn = np.linalg.svd(parts[:, own])[2].T
        parts[:, own], shapes[:, own] = parts[:, own] @ turn, shapes[:, own] @ turn
    return Whole(solved.values, shapes, np.sum(shapes * (platform @ shapes), axis=0), parts)


def _is_singular(scaled: Array) -> bool:
    try:
        if np.min(np.diag(np.linalg.cholesky(scaled))) ** 2 > _SINGULAR:
            return False
    except np.linalg.LinAlgError:
        pass
    return bool(np.linalg.eigvalsh(scaled)[0] < _SINGULAR)
