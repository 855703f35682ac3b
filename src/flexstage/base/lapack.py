"""LAPACK and BLAS, one real matrix at a time, by scipy's bindings without what else `scipy.linalg` imports, a fifth of a second.

Routines, workspace and order in memory are those that `scipy.linalg` takes, so its results are these to the last bit.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.base.binding import binding
from flexstage.base.number import Array


def lapack() -> Any:
    """The routines of LAPACK, as in `scipy.linalg.lapack`."""
    return binding("scipy.linalg._flapack", "scipy.linalg.lapack")


def blas() -> Any:
    """The routines of BLAS, as in `scipy.linalg.blas`."""
    return binding("scipy.linalg._fblas", "scipy.linalg.blas")


def cholesky(matrix: Array) -> Array:
    """L of a positive definite matrix (n, n), A = L L^T. Raises `numpy.linalg.LinAlgError` for another one."""
    if not matrix.size:
        return np.empty(matrix.shape)
    factor, fault = lapack().dpotrf(_finite(matrix), lower=True, overwrite_a=False, clean=True)
    _require(fault, "the matrix is not positive definite")
    return factor


def solve_triangular(triangle: Array, right: Array, *, lower: bool) -> Array:
    """T^-1 b of a triangle (n, n) and a right side (n,) or (n, k). Raises `numpy.linalg.LinAlgError` for a singular one."""
    if not right.size:
        return np.empty(right.shape)
    triangle, right = _finite(triangle), _finite(right)
    if triangle.flags.f_contiguous:
        found, fault = lapack().dtrtrs(triangle, right, overwrite_b=False, lower=lower, trans=0, unitdiag=False)
    else:
        found, fault = lapack().dtrtrs(triangle.T, right, overwrite_b=False, lower=not lower, trans=1, unitdiag=False)
    _require(fault, "the triangle is singular")
    return found


def pivoted_qr(matrix: Array) -> tuple[Array, Array, Array]:
    """Q (m, m), R (m, n) and the order of the columns, largest first, of a matrix (m, n).

    >>> pivoted_qr(np.array([[1.0, 2.0]]))[2].tolist()
    [1, 0]
    """
    rows, columns = matrix.shape
    if not matrix.size:
        return np.identity(rows), np.empty(matrix.shape), np.arange(columns, dtype=np.int32)
    matrix = _finite(matrix)
    geqp3, orgqr = lapack().dgeqp3, lapack().dorgqr
    factors, order, scale, _, _ = geqp3(matrix, overwrite_a=False, lwork=_space(geqp3(matrix, overwrite_a=False, lwork=-1)))
    upper, whole = np.triu(factors), np.empty((rows, rows))
    whole[:, :columns] = factors[:, :rows]
    reflected = factors[:, :rows] if rows < columns else whole
    basis, _, _ = orgqr(reflected, scale, overwrite_a=True, lwork=_space(orgqr(reflected, scale, overwrite_a=False, lwork=-1)))
    return basis, upper, order - 1


def lowest_shapes(matrix: Array, count: int) -> Array:
    """Eigenvectors (n, count) of the least eigenvalues of a symmetric matrix (n, n)."""
    matrix = _finite(matrix)
    *spaces, _ = lapack().dsyevr_lwork(n=len(matrix), lower=True)
    lwork, liwork = (int(np.real(each)) for each in spaces)
    _, shapes, found, _, fault = lapack().dsyevr(
        a=matrix, range="I", il=1, iu=count, lower=True, compute_v=1, lwork=lwork, liwork=liwork, overwrite_a=False
    )
    _require(fault, "its eigenvalues are not found")
    return shapes[:, :found]


def _finite(matrix: Array) -> Array:
    return np.asarray_chkfinite(matrix, dtype=np.float64)


def _space(asked: tuple[Any, ...]) -> int:
    """How much space a routine likes to have, by its answer when it is asked."""
    return int(asked[-2][0])


def _require(fault: int, what: str) -> None:
    if fault:
        raise np.linalg.LinAlgError(f"{what} (LAPACK: {fault})")
