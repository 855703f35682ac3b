"""Undamped eigenvalue solves of a linear model."""

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
WIDE = 128
"""Coordinates from which on a triangular solution costs less than numpy's for all matrices at once."""
ALL_MODES = 900
"""Freedoms up to which all modes of a sparse model are worked out where its lowest are asked for."""


@dataclass(frozen=True, eq=False)
class Eigen:
    """Eigenvalues lambda = omega^2 (..., k) ascending and mass-normalised shapes (..., n, k) of K phi = lambda M phi, read-only."""

    values: Array
    shapes: Array

    def __post_init__(self) -> None:
        self.values.setflags(write=False)
        self.shapes.setflags(write=False)


def eigen(model: LinearModel) -> Eigen:
    """Eigenvalues and shapes of the undamped model (Eq. 28 of Shin & Moon); modes without inertia are left out.

    Solved as K^-1 M with K = L L^T, so M may be singular. Sign rule: the largest component, rotations weighted with 0.1 m, is positive. A
    design whose K is not positive definite gives NaN. Raises `DesignError` for designs of a batch that have other numbers of modes, and for
    a large stage, of which `lowest_modes` gives some.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> (eigen(mapped(double_triangle())).values[:3] ** 0.5 / (2 * np.pi)).round(2).tolist()
    [110.91, 110.91, 135.15]
    """
    if model.stiffness_matrix.ndim > 2 or model.inertia_matrix.ndim > 2 or len(model.coordinates) > ALL_MODES:
        return _solve(model)
    return _kept(model)


@SESSION.keep(2)
def _kept(model: LinearModel) -> Eigen:
    """Of one design, kept for what asks the same model next: modes, frequencies of a response, the response itself."""
    return _solve(model)


def _solve(model: LinearModel) -> Eigen:
    return solve(model.stiffness_matrix, model.inertia_matrix, sign_weights(model.coordinates))


def eigenvalues(model: LinearModel) -> Array:
    """The values alone of `eigen`, faster; ascending.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> (eigenvalues(mapped(double_triangle()))[:3] ** 0.5 / (2 * np.pi)).round(2).tolist()
    [110.91, 110.91, 135.15]
    """
    lower, scaled = _scaled(model.stiffness_matrix, model.inertia_matrix)
    inverse_values = _massive(np.linalg.eigvalsh(scaled)[..., ::-1], lower, model.inertia_matrix)
    return np.where(np.isnan(lower[..., 0, 0])[..., None], np.nan, 1.0 / inverse_values)


def lowest_modes(model: LinearModel) -> Eigen:
    """All modes of a model; of a large sparse one some 30 of the lowest, without those of the last cluster, which may go on.

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
    """Eigenvalues and shapes of K phi = lambda M phi; `weights` (n,) compare coordinates for the sign rule.

    >>> solve(np.diag([4.0, 9.0]), np.eye(2), np.ones(2)).values.tolist()
    [4.0, 9.0]
    """
    lower, scaled = _scaled(stiffness, inertia)
    inverse_values, vectors = np.linalg.eigh(scaled)
    inverse_values = _massive(inverse_values[..., ::-1], lower, inertia)
    vectors = vectors[..., ::-1][..., : inverse_values.shape[-1]]
    shapes = np.linalg.solve(np.swapaxes(lower, -1, -2), vectors) / np.sqrt(inverse_values)[..., None, :]
    failed = np.isnan(lower[..., 0, 0])
    values = np.where(failed[..., None], np.nan, 1.0 / inverse_values)
    return Eigen(values, np.where(failed[..., None, None], np.nan, _apply_signs(shapes, weights)))


def _scaled(stiffness: Array, inertia: Array) -> tuple[Array, Array]:
    """L of K = L L^T, and L^-1 M L^-T; the unit matrix where K is not positive definite."""
    batch = np.broadcast_shapes(stiffness.shape[:-2], inertia.shape[:-2])
    stiffness = np.broadcast_to(stiffness, (*batch, *stiffness.shape[-2:]))
    lower = cholesky(stiffness)
    half = _forward(lower, np.broadcast_to(inertia, stiffness.shape))
    full = _forward(lower, np.swapaxes(half, -1, -2))
    return lower, _clean(0.5 * (full + np.swapaxes(full, -1, -2)))


def _forward(lower: Array, right: Array) -> Array:
    """L^-1 times a matrix; of large ones without factors of L."""
    size = lower.shape[-1]
    if size <= WIDE:
        return np.linalg.solve(lower, right)
    pairs = zip(lower.reshape(-1, size, size), right.reshape(-1, size, size), strict=True)
    return np.stack([scipy.linalg.solve_triangular(*pair, lower=True, check_finite=False) for pair in pairs]).reshape(right.shape)


def _massive(inverse_values: Array, lower: Array, inertia: Array) -> Array:
    """Those (..., k), descending, of modes with inertia: as many in every design that has a factor `lower`.

    Near instability one value dwarfs the others and what is left of the smallest is rounding: NaN there. How many modes there are is not in
    doubt, it is the rank of the inertia.
    """
    counts = np.sum(inverse_values > _MASSLESS * np.max(inverse_values, axis=-1, keepdims=True, initial=0.0), axis=-1)
    sound = np.ravel(~np.isnan(lower[..., 0, 0]))
    counts = np.ravel(counts)
    first = int(counts[np.argmax(sound)])
    if np.any(others := (counts != first) & sound):
        ranks = np.ravel(np.broadcast_to(_rank(inertia), inverse_values.shape[:-1]))
        if np.any(unequal := others & (ranks != ranks[np.argmax(sound)])):
            raise unlike(int(np.argmax(unequal)), "has another number of modes than the first")
        first = int(np.max(counts[sound]))
    kept = inverse_values[..., :first]
    return np.where(kept > 0.0, kept, np.nan)


def _rank(inertia: Array) -> Array:
    """Rank of each matrix, its coordinates weighted to equal inertia of their own."""
    own = np.sqrt(np.diagonal(inertia, axis1=-2, axis2=-1))
    weights = np.divide(1.0, own, out=np.zeros_like(own), where=own > 0.0)
    return np.linalg.matrix_rank(inertia * weights[..., :, None] * weights[..., None, :], tol=_MASSLESS * own.shape[-1], hermitian=True)


def cholesky(matrix: Array) -> Array:
    """Lower factor of each matrix of a batch, NaN where a matrix is not positive definite.

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
    """Failed designs become the unit matrix so that the batch can be decomposed."""
    failed = np.isnan(matrix).any(axis=(-2, -1), keepdims=True)
    return np.where(failed, np.eye(matrix.shape[-1]), matrix)


def _apply_signs(shapes: Array, weights: Array) -> Array:
    weighted = shapes * weights[:, None]
    largest = np.argmax(np.round(np.abs(weighted) / np.max(np.abs(weighted), axis=-2, keepdims=True), 6), axis=-2)
    picked = np.take_along_axis(shapes, largest[..., None, :], axis=-2)
    return shapes * np.where(picked < 0.0, -1.0, 1.0)


def sign_weights(coordinates: tuple[str, ...]) -> Array:
    """What makes lengths of coordinates (n,) to be compared: 0.1 m for rotations.

    >>> sign_weights(("arm.x", "arm.rz")).tolist()
    [1.0, 0.1]
    """
    return np.array([0.1 if name.rpartition(".")[2].startswith("r") else 1.0 for name in coordinates])
