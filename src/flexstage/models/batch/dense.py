"""All modes by dense matrices: for the nominal design, small stages, stages with locked DOFs, and designs not solved by iteration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.choice import Choice, choose, groups, participation, platform_rows
from flexstage.models.linear.eigen import cholesky, solve
from flexstage.models.linear.model import LinearModel

_SINGULAR = 1e-11
"""Minimum eigenvalue of K scaled to a unit diagonal; below it `models.lumped` treats a motion as one without stiffness."""


@dataclass(frozen=True, eq=False)
class AllModes:
    """All modes of one design: eigenvalues `values` (k,) and `shapes` (n, k); empty if the stiffness matrix is singular.

    `parts` (6, k) is the participation of the modes in the platform compliance. Repeated modes are sorted by decreasing participation.
    """

    values: Array
    shapes: Array
    parts: Array


def all_modes(stiffness: Array, inertia: Array, rows: Array, cluster: float) -> AllModes:
    """Compute all modes of one design; `rows` (6, n) gives the platform twist, `cluster` is the relative gap of repeated modes.

    >>> all_modes(np.diag([4.0, 1.0]), np.eye(2), np.eye(6, 2), 1e-6).values.tolist()
    [1.0, 4.0]
    """
    size = len(stiffness)
    none = AllModes(np.zeros(0), np.zeros((size, 0)), np.zeros((6, 0)))
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
    return AllModes(solved.values, shapes, parts)


def _is_singular(scaled: Array) -> bool:
    try:
        if np.min(np.diag(np.linalg.cholesky(scaled))) ** 2 > _SINGULAR:
            return False
    except np.linalg.LinAlgError:
        pass
    return bool(np.linalg.eigvalsh(scaled)[0] < _SINGULAR)


def modes_of_designs(model: LinearModel, count: int, cluster: float) -> list[AllModes]:
    """Compute all modes of each of the `count` designs of a model.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> (modes_of_designs(lumped(double_triangle()), 1, 1e-6)[0].values[:2] ** 0.5 / (2.0 * np.pi)).round(1).tolist()
    [106.0, 106.0]
    """
    size = len(model.coordinates)
    rows = np.eye(6, size) if model.is_sparse else platform_rows(model)
    matrices = (model.stiffness_matrix, model.inertia_matrix, rows)
    stiffness, inertia, twists = (np.broadcast_to(each, (count, *each.shape[-2:])) for each in matrices)
    return [all_modes(stiffness[number], inertia[number], twists[number], cluster) for number in range(count)]


def platform_values(modes: AllModes, choice: Choice) -> Array:
    """Compute the eigenvalues omega^2 (k,) of the platform modes of one design."""
    return modes.values[choose(modes.values[None], modes.parts[None], choice).mask[0]] if len(modes.values) else modes.values
