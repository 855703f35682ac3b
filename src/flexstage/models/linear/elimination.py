"""Exact elimination of linear constraints by a pivoted partition of the coordinates.

A z = 0 with rank r: r dependent coordinates follow from the independent ones, z_d = -A_d^-1 A_i z_i. Pivots are chosen on real parts of the
first design only, so the result stays complex-analytic and broadcasts over batch axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.lapack import pivoted_qr
from flexstage.base.number import Array, first_design

_RANK = 1e-9
_PREFERENCE = 1e-6
"""Symmetric stages tie in pivots: each column counts this much less than the one before it, so that rounding does not choose."""


@dataclass(frozen=True, eq=False)
class Elimination:
    """z = `basis` z_independent, basis (..., N, f).

    `independent` and `dependent` are indices of coordinates, `rows` of the constraints that the dependent ones follow from.
    """

    basis: Array
    independent: tuple[int, ...]
    dependent: tuple[int, ...]
    rows: tuple[int, ...]

    @property
    def rank(self) -> int:
        """Number of independent constraints."""
        return len(self.dependent)


def eliminate(constraints: Array, scale: Array, keep: tuple[int, ...] = ()) -> Elimination:
    """Eliminate the constraints A z = 0, A (..., m, N).

    `scale` (N,) makes the coordinates comparable; `keep` are kept independent if possible.

    >>> eliminate(np.array([[1.0, 2.0]]), np.ones(2), keep=(0,)).basis.ravel().tolist()
    [1.0, -0.5]
    """
    first = np.real(first_design(constraints, 2)) * scale
    norms = np.linalg.norm(first, axis=1)
    first = first / np.where(norms > 0.0, norms, 1.0)[:, None]
    dependent = _pivot_columns(first, keep)
    rows = _pivots(first[:, dependent].T)[: len(dependent)]
    independent = _without(first.shape[1], dependent)
    square = constraints[..., rows, :]
    solved = -np.linalg.solve(square[..., dependent], square[..., independent])
    basis = np.zeros((*constraints.shape[:-2], first.shape[1], len(independent)), dtype=constraints.dtype)
    basis[..., dependent, :] = solved
    basis[..., independent, :] = np.eye(len(independent))
    return Elimination(basis, tuple(independent), tuple(dependent), tuple(rows))


def imposed_motion(solution: Elimination, constraints: Array, imposed: Array) -> Array:
    """The motion z (..., N, m) of the dependent coordinates alone that gives the constraints the values A z = imposed (m of m columns).

    >>> rows = np.array([[1.0, 2.0]])
    >>> imposed_motion(eliminate(rows, np.ones(2), keep=(0,)), rows, np.array([[3.0]])).ravel().tolist()
    [0.0, 1.5]
    """
    square = constraints[..., solution.rows, :][..., solution.dependent]
    result = np.zeros((*constraints.shape[:-2], constraints.shape[-1], imposed.shape[-1]), dtype=constraints.dtype)
    wanted = np.broadcast_to(imposed[list(solution.rows)], (*square.shape[:-2], len(solution.rows), imposed.shape[-1]))
    result[..., solution.dependent, :] = np.linalg.solve(square, wanted)
    return result


def _pivot_columns(first: Array, keep: tuple[int, ...]) -> list[int]:
    """Dependent columns: as many as possible outside `keep`, the rest inside."""
    outside = _without(first.shape[1], keep)
    if not first.size:
        return []
    orthogonal, triangle, order = pivoted_qr(_preference(first[:, outside]))
    rank = _rank(triangle)
    dependent = [outside[index] for index in order[:rank]]
    left = (orthogonal.T @ first[:, list(keep)])[rank:]
    if left.size:
        dependent += [keep[index] for index in _pivots(left)]
    return dependent


def _pivots(matrix: Array) -> list[int]:
    """Indices of a maximal set of independent columns, best conditioned first."""
    if not matrix.size:
        return []
    _, triangle, order = pivoted_qr(_preference(matrix))
    return [int(index) for index in order[: _rank(triangle)]]


def _preference(matrix: Array) -> Array:
    return matrix * (1.0 - _PREFERENCE * np.arange(matrix.shape[1]))


def _without(size: int, left_out: Sequence[int]) -> list[int]:
    unwanted = set(left_out)
    return [index for index in range(size) if index not in unwanted]


def _rank(triangle: Array) -> int:
    diagonal = np.abs(np.diag(triangle))
    return int(np.sum(diagonal > _RANK))


def echelon(basis: Array) -> Array:
    """The same row space with a unit in a pivot column of each row and zeros in that column elsewhere: vectors with small support.

    >>> (echelon(np.array([[1.0, 1.0], [1.0, -1.0]])) + 0.0).tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    if not basis.size:
        return basis
    columns = sorted(_pivots(basis))
    return np.linalg.solve(basis[:, columns], basis)


def null_space(matrix: Array) -> Array:
    """Orthonormal basis (columns) of the null space of one real matrix whose columns are comparable, by pivoted QR of its transpose.

    >>> np.abs(null_space(np.array([[1.0, 0.0]]))).round(12).ravel().tolist()
    [0.0, 1.0]
    """
    if not matrix.size:
        return np.eye(matrix.shape[1])
    orthogonal, triangle, _ = pivoted_qr(_preference(matrix.T))
    diagonal = np.abs(np.diag(triangle))
    return orthogonal[:, int(np.sum(diagonal > _RANK * diagonal[0])) :]
