"""Undamped eigenvalue solutions of a linear model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.base.session import SESSION
from flexstage.models.linear.elimination import unlike
from flexstage.models.linear.large import lowest
from flexstage.models.linear.model import LinearModel

_MASSLESS = 1e-13
_CLUSTER = 1e-5
_BELOW = 1e-2
"""Eigenvalue of grounded floating motions over the lowest elastic one, so that they are the first."""
WIDE = 128
"""Number of coordinates above which solving triangular systems one by one is faster than numpy's solution of all systems at once."""
ALL_MODES = 900
"""Number of coordinates up to which all modes of a sparse model are computed, even if only the lowest are requested."""


@dataclass(frozen=True, eq=False)
class Eigen:
    """Solution of K phi = lambda M phi: ascending eigenvalues lambda = omega^2 (..., k), mass-normalised shapes (..., n, k). Read-only."""

    values: Array
    shapes: Array

    def __post_init__(self) -> None:
        self.values.setflags(write=False)
        self.shapes.setflags(write=False)


def eigen(model: LinearModel) -> Eigen:
    """Compute eigenvalues and shapes of the undamped model (equation 28 of Shin & Moon), without modes that have no inertia.

    The problem is solved with K^-1 M and K = L L^T, so that M may be singular. Sign rule: the largest component of a shape, with rotations
    multiplied by 0.1 m, is positive. A design whose K is not positive definite gives NaN.

    Raises `DesignError` for a batch of designs with different numbers of modes, and for a large stage (use `lowest_modes`).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> (eigen(mapped(double_triangle())).values[:3] ** 0.5 / (2 * np.pi)).round(2).tolist()
    [110.91, 110.91, 135.15]
    """
    if model.stiffness_matrix.ndim > 2 or model.inertia_matrix.ndim > 2 or len(model.coordinates) > ALL_MODES:
        return _solve(model)
    return _cached(model)


@SESSION.keep(2)
def _cached(model: LinearModel) -> Eigen:
    """Result of one design, cached for further calls with the same model: modes, response frequencies, response."""
    return _solve(model)


def _solve(model: LinearModel) -> Eigen:
    weights = sign_weights(model.coordinates)
    if model.floating is None:
        return solve(model.stiffness_matrix, model.inertia_matrix, weights)
    count = model.floating.shape[-1]
    values = solve(model.grounded(model.scale), model.inertia_matrix, weights).values
    elastic = np.delete(values, np.argsort(np.abs(values - model.scale))[:count])
    solved = solve(model.grounded(_BELOW * np.min(elastic, initial=model.scale)), model.inertia_matrix, weights)
    shapes = np.concatenate([_apply_signs(model.floating, weights), solved.shapes[:, count:]], axis=-1)
    return Eigen(np.concatenate([np.zeros(count), solved.values[count:]]), shapes)


def eigenvalues(model: LinearModel) -> Array:
    """Compute the same ascending eigenvalues (..., k) as `eigen`, but without shapes, which is faster.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> (eigenvalues(mapped(double_triangle()))[:3] ** 0.5 / (2 * np.pi)).round(2).tolist()
    [110.91, 110.91, 135.15]
    """
    if model.floating is not None:
        return eigen(model).values
    lower, scaled = _scaled(model.stiffness_matrix, model.inertia_matrix)
    inverse_values = _massive(np.linalg.eigvalsh(scaled)[..., ::-1], lower, model.inertia_matrix)
    return np.where(np.isnan(lower[..., 0, 0])[..., None], np.nan, 1.0 / inverse_values)


def lowest_modes(model: LinearModel) -> Eigen:
    """Compute all modes; for a large sparse model, only about 30 of the lowest modes.

    For a large model, the highest cluster of computed modes is omitted, because some of its modes may be missing.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> lowest_modes(mapped(double_triangle())).values.shape
    (6,)
    """
    if not model.is_sparse or len(model.coordinates) <= ALL_MODES:
        return eigen(model)
    values, shapes = lowest(model.solver, model.masses)
    apart = np.flatnonzero(np.diff(values) > _CLUSTER * values[1:])
    kept = int(apart[-1]) + 1 if len(apart) else len(values)
    return Eigen(values[:kept], _apply_signs(shapes[:, :kept], sign_weights(model.coordinates)))


def solve(stiffness: Array, inertia: Array, weights: Array) -> Eigen:
    """Solve K phi = lambda M phi for eigenvalues and shapes. `weights` (n,) make the coordinates comparable for the sign rule.

    >>> solve(np.diag([4.0, 9.0]), np.eye(2), np.ones(2)).values.tolist()
    [4.0, 9.0]
    """
    lower, scaled = _scaled(stiffness, inertia)
    inverse_values, vectors = np.linalg.eigh(scaled)
    inverse_values = _massive(inverse_values[..., ::-1], lower, inertia)
    vectors = vectors[..., ::-1][..., : inverse_values.shape[-1]]
    shapes = np.linalg.solve(lower.mT, vectors) / np.sqrt(inverse_values)[..., None, :]
    failed = np.isnan(lower[..., 0, 0])
    values = np.where(failed[..., None], np.nan, 1.0 / inverse_values)
    return Eigen(values, np.where(failed[..., None, None], np.nan, _apply_signs(shapes, weights)))


def _scaled(stiffness: Array, inertia: Array) -> tuple[Array, Array]:
    """L of K = L L^T, and L^-1 M L^-T; the unit matrix if K is not positive definite."""
    batch = np.broadcast_shapes(stiffness.shape[:-2], inertia.shape[:-2])
    stiffness = np.broadcast_to(stiffness, (*batch, *stiffness.shape[-2:]))
    lower = cholesky(stiffness)
    half = _forward(lower, np.broadcast_to(inertia, stiffness.shape))
    full = _forward(lower, half.mT)
    return lower, _clean(0.5 * (full + full.mT))


def _forward(lower: Array, right: Array) -> Array:
    """L^-1 times a matrix; for large matrices without inverting L."""
    size = lower.shape[-1]
    if size <= WIDE:
        return np.linalg.solve(lower, right)
    pairs = zip(lower.reshape(-1, size, size), right.reshape(-1, size, size), strict=True)
    return np.stack([scipy.linalg.solve_triangular(*pair, lower=True, check_finite=False) for pair in pairs]).reshape(right.shape)


def _massive(inverse_values: Array, lower: Array, inertia: Array) -> Array:
    """Values (..., k), descending, of modes with inertia: equal in number for every design that has a factor `lower`.

    Near instability one value dominates and the smallest are rounding: NaN there. The number of modes is known nevertheless: it is the rank
    of the inertia.
    """
    counts = np.sum(inverse_values > _MASSLESS * np.max(inverse_values, axis=-1, keepdims=True, initial=0.0), axis=-1)
    sound = np.ravel(~np.isnan(lower[..., 0, 0]))
    counts = np.ravel(counts)
    first = int(counts[np.argmax(sound)])
    if np.any(others := (counts != first) & sound):
        ranks = np.ravel(np.broadcast_to(_rank(inertia), inverse_values.shape[:-1]))
        if np.any(unequal := others & (ranks != ranks[np.argmax(sound)])):
            raise unlike(int(np.argmax(unequal)), "differs from the first design in its number of modes")
        first = int(np.max(counts[sound]))
    kept = inverse_values[..., :first]
    return np.where(kept > 0.0, kept, np.nan)


def _rank(inertia: Array) -> Array:
    """Rank of each matrix, its coordinates weighted to equal inertia."""
    own = np.sqrt(np.diagonal(inertia, axis1=-2, axis2=-1))
    weights = np.divide(1.0, own, out=np.zeros_like(own), where=own > 0.0)
    return np.linalg.matrix_rank(inertia * weights[..., :, None] * weights[..., None, :], tol=_MASSLESS * own.shape[-1], hermitian=True)


def cholesky(matrix: Array) -> Array:
    """Compute the lower Cholesky factor of each matrix of a batch, NaN if a matrix is not positive definite.

    >>> cholesky(np.array([[[4.0]], [[-1.0]]])).ravel().tolist()
    [2.0, nan]
    """
    try:
        return np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        flat = matrix.reshape(-1, *matrix.shape[-2:])
        return np.stack([_cholesky_one(item) for item in flat]).reshape(matrix.shape)


def _cholesky_one(matrix: Array) -> Array:
    try:
        return np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        return np.full(matrix.shape, np.nan)


def _clean(matrix: Array) -> Array:
    """Replace failed designs with the unit matrix so that the batch can be decomposed."""
    failed = np.isnan(matrix).any(axis=(-2, -1), keepdims=True)
    return np.where(failed, np.eye(matrix.shape[-1]), matrix)


def _apply_signs(shapes: Array, weights: Array) -> Array:
    weighted = shapes * weights[:, None]
    largest = np.argmax(np.round(np.abs(weighted) / np.max(np.abs(weighted), axis=-2, keepdims=True), 6), axis=-2)
    picked = np.take_along_axis(shapes, largest[..., None, :], axis=-2)
    return shapes * np.where(picked < 0.0, -1.0, 1.0)


def sign_weights(coordinates: tuple[str, ...]) -> Array:
    """Return weights that make coordinates (n,) comparable as lengths: 0.1 m for rotations.

    >>> sign_weights(("arm.x", "arm.rz")).tolist()
    [1.0, 0.1]
    """
    return np.array([0.1 if name.rpartition(".")[2].startswith("r") else 1.0 for name in coordinates])
