"""Platform frequencies: up to each of these frequencies, the modes reach a tenth of the static compliance in one more direction.

The platform twist in a mass-normalised mode is phi. The platform's static compliance is C = sum phi phi^T / omega^2. H(f) is the sum over
the modes up to frequency f of C^(-1/2) phi phi^T C^(-1/2) / omega^2. Platform frequency k is the lowest f at which k eigenvalues of H
exceed `THRESHOLD`. The eigenvalues of H do not depend on units, on the reference point, on the basis of repeated modes, or on modes above
f.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.linear.eigen import cholesky, eigen
from flexstage.models.linear.model import LinearModel
from flexstage.spatial.frame import COMPONENTS

THRESHOLD = 0.1
"""Fraction of the static compliance that the modes must exceed in a direction. Most stages give equal results from 0.1 to 0.7."""

MARGIN = 5e-3
"""Required distance of the eigenvalues of H from the threshold. Errors of modes from the iteration change H by 2e-3 at most."""

_LOCKED = 1e-12
"""Relative square root of a compliance below which a direction is locked, with rotations taken over 0.1 m."""
_LENGTHS = np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])


@dataclass(frozen=True)
class Choice:
    """Number of requested platform frequencies, and the relative gap below which neighbouring frequencies form a cluster."""

    count: int = 6
    cluster: float = 1e-6


@dataclass(frozen=True, eq=False)
class ModeSelection:
    """Selected modes of b designs: `mask` (b, k) marks the platform modes; `exact` (b,) is true if their number is the requested number.

    If only some modes of a cluster are platform modes, the modes with the largest participation are selected.
    """

    mask: Array
    exact: Array


def platform_rows(model: LinearModel) -> Array:
    """Return the matrix (..., 6, n) from the coordinates of the model to the platform twist.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> platform_rows(mapped(double_triangle())).shape
    (6, 6)
    """
    return model.output[..., model.output_index(tuple(f"{PLATFORM}.{name}" for name in COMPONENTS)), :]


def compliance_root(model: LinearModel, rows: Array) -> Array:
    """Compute a root R (..., r, 6) of the static compliance C = R^T R for the motions `rows` (..., 6, n).

    The result is NaN if the stiffness matrix is not positive definite.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> model = mapped(double_triangle())
    >>> root = compliance_root(model, platform_rows(model))
    >>> round(1e-6 / float(root[:, 2] @ root[:, 2]), 3)  # K_z, N/um
    10.093
    """
    turned = rows.mT
    if model.floating is not None:
        solved = eigen(model)
        elastic = solved.values > 0.0
        root = (rows @ solved.shapes[:, elastic]).mT / np.sqrt(solved.values[elastic])[:, None]
        return np.concatenate([root, np.zeros((1, len(COMPONENTS)))])
    if model.is_sparse:
        return cholesky(rows @ model.solve(turned)).mT
    return np.linalg.solve(cholesky(model.stiffness_matrix), turned)


def participation(root: Array, motions: Array, values: Array) -> Array:
    """Compute the participation p = C^(-1/2) phi / omega (..., 6, k) of k modes in the compliance C = R^T R; `root` is R (..., r, 6).

    `motions` (..., 6, k) are the platform twists phi, `values` (..., k) the eigenvalues omega^2. The squared length of the column p of a
    mode is the mode's fraction of the compliance along the mode's own motion. Over all modes, the products p p^T add up to the unit matrix.
    Directions without compliance are excluded.

    >>> participation(np.diag([0.5] * 6), np.eye(6), np.full(6, 4.0)).diagonal().tolist()  # springs of 4 N/m, masses of 1 kg
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    """
    root = np.where(np.all(np.isfinite(root), axis=(-2, -1), keepdims=True), root, 0.0)
    size = np.sqrt(np.sum(root**2, axis=-2)) * _LENGTHS
    scale = np.where(size > _LOCKED * np.max(size, axis=-1, keepdims=True), size, np.inf) / _LENGTHS
    turn, lengths, axes = np.linalg.svd(root / scale[..., None, :], full_matrices=False)
    del turn
    inverse = np.divide(1.0, lengths, out=np.zeros_like(lengths), where=lengths > _LOCKED * np.max(lengths, axis=-1, keepdims=True))
    parts = inverse[..., None] * (axes @ (motions / scale[..., None] / np.sqrt(values)[..., None, :]))
    return np.nan_to_num(parts, posinf=0.0, neginf=0.0)


def choose(values: Array, parts: Array, choice: Choice) -> ModeSelection:
    """Choose the modes of the platform frequencies from ascending eigenvalues (b, k) and their `participation` (b, 6, k).

    >>> parts = np.array([[[0.2, 0.0, 0.9], [0.0, 0.6, 0.3]]])
    >>> choose(np.array([[1.0, 2.0, 3.0]]), parts, Choice(count=2)).mask.tolist()
    [[False, True, True]]
    """
    shares = np.linalg.eigvalsh(np.cumsum(np.moveaxis(parts[:, :, None] * parts[:, None], -1, 1), axis=1))
    first, last = _ends(groups(np.sqrt(values), choice.cluster))
    count = np.take_along_axis(np.sum(shares > THRESHOLD, axis=-1), last, axis=1)
    before, after = (
        np.minimum(each, choice.count) for each in (np.where(first > 0, np.take_along_axis(count, first - 1, axis=1), 0), count)
    )
    order, rank = np.lexsort((-np.sum(parts**2, axis=1), first)), np.empty_like(first)
    np.put_along_axis(rank, order, np.broadcast_to(np.arange(rank.shape[1]), rank.shape), axis=1)
    mask = before + rank - first < after
    return ModeSelection(mask, mask.sum(axis=1) == choice.count)


def groups(values: Array, gap: float) -> Array:
    """Return cluster numbers (b, k) of ascending values. A relative gap above `gap` starts a new cluster.

    >>> groups(np.array([[1.0, 1.0 + 1e-9, 2.0]]), 1e-6).tolist()
    [[0, 0, 1]]
    """
    with np.errstate(invalid="ignore"):
        new = ~(values[:, 1:] - values[:, :-1] <= gap * values[:, 1:])
    return np.concatenate([np.zeros((len(values), min(1, values.shape[1])), dtype=int), np.cumsum(new, axis=1)], axis=1)


def _ends(group: Array) -> tuple[Array, Array]:
    """The first and the last member (b, k) of each value's group."""
    return (
        np.sum(group[:, None] < group[..., None], axis=-1),
        np.sum(group[:, None] <= group[..., None], axis=-1) - 1,
    )
