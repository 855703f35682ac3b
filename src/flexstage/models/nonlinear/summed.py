"""Assembly of matrices from blocks over the unknowns of a stage: dense for few bodies, sparse for many (docs/decisions/0078)."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.models.nonlinear.elements.condense import solve

MANY = 400
"""Number of unknowns above which assembled matrices are sparse."""


class Sum(Protocol):
    """Protocol for matrices of b cases that are assembled by adding blocks."""

    def add(self, rows: slice, columns: slice, block: Array) -> None:
        """Add a block (b, r, c) of every case at r `rows` and c `columns`."""

    def spread(self, rows: Array, columns: Array, blocks: Array) -> None:
        """Add l blocks (l, b, r, c). `rows` (l,) and `columns` (l,) contain the first row and the first column of each block."""

    def total(self, kept: Array) -> Array | tuple[Any, ...]:
        """Return the matrices with only the rows and columns `kept`: an array (b, n, n), or sparse matrices."""
        ...


class Dense:
    """Dense matrices of b cases, assembled from blocks."""

    def __init__(self, cases: int, size: int) -> None:
        self._whole = np.zeros((cases, size, size))

    def add(self, rows: slice, columns: slice, block: Array) -> None:
        """Add a block (b, r, c) of every case at r `rows` and c `columns`."""
        self._whole[:, rows, columns] += block

    def spread(self, rows: Array, columns: Array, blocks: Array) -> None:
        """Add l blocks (l, b, r, c). `rows` (l,) and `columns` (l,) contain the first row and the first column of each block."""
        high, wide = blocks.shape[-2:]
        for row, column, block in zip(rows, columns, blocks, strict=True):
            self._whole[:, row : row + high, column : column + wide] += block

    def total(self, kept: Array) -> Array:
        """Return the matrices (b, n, n) with only the rows and columns `kept`."""
        return self._whole[:, kept[:, None], kept]


class Blocks:
    """Sparse matrices of b cases, stored as blocks, each with its first row and column."""

    def __init__(self, cases: int, size: int) -> None:
        self._cases, self._size = cases, size
        self._found: list[tuple[Array, Array, Array]] = []

    def add(self, rows: slice, columns: slice, block: Array) -> None:
        """Add a block (b, r, c) of every case at r `rows` and c `columns`."""
        shape = (1, self._cases, rows.stop - rows.start, columns.stop - columns.start)
        self.spread(np.array([rows.start]), np.array([columns.start]), np.broadcast_to(block, shape))

    def spread(self, rows: Array, columns: Array, blocks: Array) -> None:
        """Add l blocks (l, b, r, c). `rows` (l,) and `columns` (l,) contain the first row and the first column of each block."""
        self._found.append((rows, columns, blocks))

    def total(self, kept: Array) -> tuple[Any, ...]:
        """Return sparse matrices (n, n), one per case."""
        place = np.full(self._size, -1)
        place[kept] = np.arange(len(kept))
        rows, columns, values = [np.zeros(0, dtype=int)], [np.zeros(0, dtype=int)], [np.zeros((self._cases, 0))]
        for first, second, blocks in self._found:
            high, wide = blocks.shape[-2:]
            shape = (len(blocks), high, wide)
            rows.append(np.broadcast_to(place[first[:, None, None] + np.arange(high)[:, None]], shape).ravel())
            columns.append(np.broadcast_to(place[second[:, None, None] + np.arange(wide)], shape).ravel())
            values.append(np.moveaxis(blocks, 1, 0).reshape(self._cases, -1))
        row, column, value = np.concatenate(rows), np.concatenate(columns), np.concatenate(values, axis=1)
        inside = (row >= 0) & (column >= 0)
        size = len(kept)
        return tuple(scipy.sparse.coo_array((each[inside], (row[inside], column[inside])), (size, size)).tocsc() for each in value)


def empty_sum(cases: int, size: int) -> Sum:
    """Return a zero sum (b, size, size)."""
    return Blocks(cases, size) if size > MANY else Dense(cases, size)


def solved(matrix: Array | tuple[Any, ...], right: Array) -> Array:
    """Solve linear systems for right sides (b, n); returns (b, n), NaN if a case is singular."""
    if isinstance(matrix, np.ndarray):
        return solve(matrix, right[..., None])[..., 0]
    return np.stack([_solved(one, each) for one, each in zip(matrix, right, strict=True)])


def _solved(matrix: Any, right: Array) -> Array:
    try:
        return scipy.sparse.linalg.splu(matrix).solve(right)
    except (RuntimeError, ValueError):  # singular, or not finite
        return np.full_like(right, np.nan)


def negative_pivots(matrix: Any, freedoms: int) -> int:
    """Count the negative eigenvalues of the symmetric form of [K, C^T; C, 0] by Sylvester's law of inertia.

    The stiffness K has `freedoms` rows; the rows of C are constraints. The count is the number of negative pivots of K plus the number of
    negative eigenvalues of - C K^-1 C^T.
    """
    even = (0.5 * (matrix + matrix.T)).tocsc()
    factor = scipy.sparse.linalg.splu(
        even[:freedoms, :freedoms], permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    count = int(np.sum(factor.U.diagonal() < 0.0))
    rows = even[freedoms:, :freedoms].toarray()
    return count + (int(np.sum(np.linalg.eigvalsh(rows @ factor.solve(rows.T)) > 0.0)) if len(rows) else 0)


def nearest_descent(matrix: Any, scale: Array) -> tuple[float, Array]:
    """Compute the lowest eigenvalue of the scaled stiffness K among motions that meet constraints C, and its vector (n,).

    The whole matrix is [K, C^T; C, 0]; the admissible motions are the null space of C. Rows and columns of K are divided by `scale` (n,).

    Lanczos' method on the inverse gives the two eigenvalues nearest to zero; the negative eigenvalue, if any, is returned.
    """
    count = len(scale)
    whole = np.concatenate([scale, np.ones(matrix.shape[0] - count)])
    even = scipy.sparse.diags_array(1.0 / whole) @ (0.5 * (matrix + matrix.T)) @ scipy.sparse.diags_array(1.0 / whole)
    factor = scipy.sparse.linalg.splu(even.tocsc())
    none = np.zeros(len(whole) - count)

    def flexibility(force: Array) -> Array:
        return factor.solve(np.concatenate([np.ravel(force), none]))[:count]

    operator = scipy.sparse.linalg.LinearOperator((count, count), matvec=flexibility, dtype=float)
    values, vectors = scipy.sparse.linalg.eigsh(operator, k=2, which="LM", v0=np.ones(count))
    chosen = int(np.argmin(values)) if np.min(values) < 0.0 else int(np.argmax(values))
    return 1.0 / float(values[chosen]), vectors[:, chosen]
