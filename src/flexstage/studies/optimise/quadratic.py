"""Small strictly convex quadratic programs, by the dual active-set method."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array

_TINY = 1e-12


@dataclass(frozen=True, eq=False)
class Solution:
    """The minimiser (n,) and the multipliers (m,) of the constraints, none negative."""

    at: Array
    multipliers: Array


def quadratic(hessian: Array, linear: Array, normals: Array, bounds: Array) -> Solution:
    """Minimise x^T H x / 2 + h^T x where A x <= b, for H positive definite and constraints that can be met.

    Goldfarb & Idnani, Mathematical Programming 27 (1983) 1: from the free minimiser, the most violated constraint is taken in, and those
    whose multiplier would turn negative are let go, until none is violated.

    >>> found = quadratic(np.eye(2), np.array([-2.0, -1.0]), np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([1.0, 5.0]))
    >>> found.at.tolist(), found.multipliers.tolist()
    ([1.0, 1.0], [1.0, 0.0])
    """
    lower = np.linalg.cholesky(hessian)
    rows = np.linalg.solve(lower, normals.T).T  # in y = L^T x the Hessian is the unit matrix
    length = np.maximum(np.sqrt(np.sum(rows * rows, axis=1)), 1e-300)
    rows, bounds = rows / length[:, None], bounds / length
    point = -np.linalg.solve(lower, linear)
    working: list[int] = []
    duals = np.zeros(0)
    for _ in range(20 * (len(bounds) + len(linear)) + 20):
        excess = rows @ point - bounds
        excess[working] = 0.0
        worst = int(np.argmax(excess)) if len(excess) else -1
        if worst < 0 or excess[worst] <= _TINY * (1.0 + abs(bounds[worst])):
            break
        point, working, duals = _taken(rows, bounds, (point, working, duals), worst)
    multipliers = np.zeros(len(bounds))
    multipliers[working] = duals
    return Solution(np.linalg.solve(lower.T, point), multipliers / length)


def _taken(rows: Array, bounds: Array, state: tuple[Array, list[int], Array], worst: int) -> tuple[Array, list[int], Array]:
    """Take a violated constraint into the working set."""
    point, working, duals = state
    own = 0.0
    for _ in range(len(working) + 1):
        basis = rows[working].T
        share = np.linalg.lstsq(basis, rows[worst], rcond=None)[0] if working else np.zeros(0)
        away = rows[worst] - basis @ share
        gain = float(away @ away)
        excess = float(rows[worst] @ point - bounds[worst])
        full = excess / gain if gain > _TINY else np.inf
        ratios = np.where(share > _TINY, duals / np.where(share > _TINY, share, 1.0), np.inf)
        leaving = int(np.argmin(ratios)) if len(ratios) else -1
        part = float(ratios[leaving]) if leaving >= 0 else np.inf
        step = min(full, part)
        if not np.isfinite(step):  # dependent on the working set, and none of it can go: as near as rounding lets it
            return point, working, duals
        point, duals, own = point - step * away, duals - step * share, own + step
        if full <= part:
            return point, [*working, worst], np.append(duals, own)
        working, duals = [each for number, each in enumerate(working) if number != leaving], np.delete(duals, leaving)
    return point, working, duals
