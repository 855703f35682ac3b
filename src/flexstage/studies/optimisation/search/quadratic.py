"""Small strictly convex quadratic programs, solved as least-distance problems."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.base.number import Array

_TINY = 1e-300


@dataclass(frozen=True, eq=False)
class Solution:
    """The minimiser (n,) and the non-negative multipliers (m,) of the constraints."""

    at: Array
    multipliers: Array


def quadratic(hessian: Array, linear: Array, normals: Array, bounds: Array) -> Solution:
    """Minimise x^T H x / 2 + h^T x subject to A x <= b.

    The `hessian` H is positive definite, h is `linear`, and A (`normals`) and b (`bounds`) are the constraints, which must be feasible. In
    the coordinates y = L^T x with H = L L^T, a step z from the unconstrained minimiser must satisfy constraints G z >= g. The solution is
    the shortest such step. It is z = G^T u / (1 - g^T u), where u >= 0 minimises |E u - e| with E = [G^T; g^T] and e = (0, ..., 0, 1)
    (Lawson & Hanson, Solving Least Squares Problems, 1974, chapter 23).

    >>> found = quadratic(np.eye(2), np.array([-2.0, -1.0]), np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([1.0, 5.0]))
    >>> found.at.round(12).tolist(), found.multipliers.round(12).tolist()
    ([1.0, 1.0], [1.0, 0.0])
    """
    lower = np.linalg.cholesky(hessian)
    free = -np.linalg.solve(lower, linear)
    rows = -np.linalg.solve(lower, normals.T).T
    length = np.maximum(np.linalg.norm(rows, axis=1), _TINY)
    rows = rows / length[:, None]
    away = -bounds / length - rows @ free
    scale = float(np.max(away, initial=0.0))
    if scale <= 0.0:
        return Solution(np.linalg.solve(lower.T, free), np.zeros(len(bounds)))
    share, _ = scipy.optimize.nnls(np.vstack([rows.T, away / scale]), np.append(np.zeros(len(free)), 1.0))
    multipliers = scale * share / (1.0 - away @ share / scale)
    return Solution(np.linalg.solve(lower.T, free + rows.T @ multipliers), multipliers / length)
