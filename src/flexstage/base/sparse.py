"""Sparse matrices: matrices with few nonzero columns, and operations on them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
import scipy

from flexstage.base.number import Array


class _Operator:
    """Real matrix in place of a dense array: products are arrays, other numpy functions use the dense matrix."""

    __array_priority__ = 100.0
    __array_ufunc__ = None
    ndim = 2

    @property
    def real(self) -> Self:
        """The matrix itself, which is real."""
        return self

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:  # noqa: FBT001 (numpy's protocol)
        return np.asarray(self._dense(), dtype=dtype, copy=copy)

    def __getitem__(self, index: Any) -> Any:
        """Rows `[..., rows, :]` in the form of `_rows`; any other part dense."""
        if index == ():
            return self
        if isinstance(index, tuple) and len(index) == 3 and index[0] is ... and isinstance(index[2], slice) and index[2] == slice(None):
            return self._rows(index[1])
        return np.asarray(self)[index]

    @property
    def mT(self) -> Array:
        """The dense transpose."""
        return np.asarray(self).mT

    def _dense(self) -> Array:
        raise NotImplementedError

    def _rows(self, rows: Any) -> Any:
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class Sparse(_Operator):
    """Real matrix (r, n) that is zero except for `columns` (c,) with `values` (r, c). Values of repeated columns are added.

    A `Sparse` can replace a dense operator (r, n). Products with arrays are arrays; other numpy functions use the dense matrix.

    >>> import numpy as np
    >>> rows = Sparse(np.array([2]), np.array([[3.0]]), 4)
    >>> (rows @ np.arange(4.0)[:, None]).tolist(), np.asarray(rows).tolist()
    ([[6.0]], [[0.0, 0.0, 3.0, 0.0]])
    """

    columns: Array
    values: Array
    size: int

    @property
    def shape(self) -> tuple[int, int]:
        """Shape (r, n)."""
        return self.values.shape[0], self.size

    @property
    def dtype(self) -> Any:
        """Type of the values."""
        return self.values.dtype

    def _dense(self) -> Array:
        return as_csr([self], self.size).toarray()

    def _rows(self, rows: Any) -> Sparse:
        return Sparse(self.columns, self.values[..., rows, :], self.size)

    def __matmul__(self, motion: Array) -> Array:
        return self.values @ motion[..., self.columns, :]

    def __rmatmul__(self, law: Array) -> Sparse:
        return Sparse(self.columns, law @ self.values, self.size)

    def __sub__(self, other: Sparse) -> Sparse:
        return self + Sparse(other.columns, -other.values, other.size)

    def __add__(self, other: Sparse) -> Sparse:
        return Sparse(np.concatenate([self.columns, other.columns]), np.concatenate([self.values, other.values], axis=1), self.size)

    def __rmul__(self, factor: Array) -> Sparse:
        return Sparse(self.columns, np.real(factor) * self.values, self.size)


def few(matrix: Array | Sparse) -> Sparse:
    """Convert a real matrix (r, n) to `Sparse`, without empty columns.

    >>> import numpy as np
    >>> few(np.array([[0.0, 2.0, 0.0]])).columns.tolist()
    [1]
    """
    if isinstance(matrix, Sparse):
        return matrix
    columns = np.flatnonzero(np.any(matrix != 0.0, axis=tuple(range(matrix.ndim - 1))))
    return Sparse(columns, np.ascontiguousarray(matrix[..., columns]), matrix.shape[-1])


def below(rows: Iterable[Sparse], size: int) -> Sparse:
    """Stack several matrices vertically.

    >>> import numpy as np
    >>> one = Sparse(np.array([1]), np.array([[3.0]]), 2)
    >>> np.asarray(below([one, one], 2)).tolist()
    [[0.0, 3.0], [0.0, 3.0]]
    """
    parts = list(rows)
    batch = np.broadcast_shapes(*(part.values.shape[:-2] for part in parts))
    counts = [part.values.shape[-2:] for part in parts]
    values = np.zeros((*batch, *np.sum(counts, axis=0)), dtype=np.result_type(*(part.values for part in parts)))
    row = column = 0
    for part, (high, wide) in zip(parts, counts, strict=True):
        values[..., row : row + high, column : column + wide] = part.values
        row, column = row + high, column + wide
    return Sparse(np.concatenate([part.columns for part in parts]), values, size)


def as_csr(rows: Iterable[Sparse], size: int) -> Any:
    """Stack many matrices vertically as one `scipy.sparse.csr_array` (R, size)."""
    parts = list(rows)
    data = np.concatenate([part.values.ravel() for part in parts]) if parts else np.zeros(0)
    columns = [np.broadcast_to(part.columns, part.values.shape).ravel() for part in parts]
    counts = np.concatenate([np.full(len(part.values), len(part.columns)) for part in parts]) if parts else np.zeros(0, dtype=int)
    starts = np.concatenate([[0], np.cumsum(counts)])
    result = scipy.sparse.csr_array((data, np.concatenate(columns) if columns else np.zeros(0, dtype=int), starts), (len(counts), size))
    result.sum_duplicates()
    return result


def block_diagonal(blocks: Iterable[Array]) -> Any:
    """Return a block-diagonal matrix as one `scipy.sparse.csr_array`.

    >>> block_diagonal([np.eye(1), 2.0 * np.eye(2)]).toarray().diagonal().tolist()
    [1.0, 2.0, 2.0]
    """
    parts = [np.asarray(block) for block in blocks]
    starts = np.concatenate([[0], np.cumsum([len(part) for part in parts])])
    rows = [Sparse(np.arange(start, start + len(part)), part, int(starts[-1])) for start, part in zip(starts, parts, strict=False)]
    return as_csr(rows, int(starts[-1]))


@dataclass(frozen=True, eq=False)
class Rows(_Operator):
    """Matrix (p, n) with a row for each of many outputs, stored by its nonzero entries. Selected rows are returned as dense arrays.

    >>> import numpy as np
    >>> tall = Rows.of([Sparse(np.array([2]), np.array([[3.0]]), 4)], 4)
    >>> tall[..., [0], :].tolist(), tall.shape
    ([[0.0, 0.0, 3.0, 0.0]], (1, 4))
    """

    entries: Any

    @staticmethod
    def of(rows: Iterable[Sparse], size: int) -> Rows:
        """Stack matrices with `size` columns vertically."""
        return Rows(as_csr(rows, size))

    @property
    def shape(self) -> tuple[int, int]:
        """Shape (p, n)."""
        return self.entries.shape

    def few(self, first: int, count: int) -> Sparse:
        """Return `count` consecutive rows from row `first`, without empty columns."""
        starts = self.entries.indptr[first : first + count + 1]
        own = self.entries.indices[starts[0] : starts[-1]]
        columns = np.unique(own)
        values = np.zeros((count, len(columns)))
        rows = np.repeat(np.arange(count), np.diff(starts))
        values[rows, np.searchsorted(columns, own)] = self.entries.data[starts[0] : starts[-1]]
        return Sparse(columns, values, self.shape[1])

    @cached_property
    def dtype(self) -> Any:
        """Type of the entries."""
        return self.entries.dtype

    def _dense(self) -> Array:
        return self.entries.toarray()

    def _rows(self, rows: Any) -> Array:
        return self.entries[rows].toarray()

    def __matmul__(self, motion: Array) -> Array:
        return self.entries @ motion
