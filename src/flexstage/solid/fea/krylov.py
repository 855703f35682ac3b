"""The lowest modes of large models by blocks of inverse iteration: a factor serves many vectors in the time of a few."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexstage.base.number import Array

_BLOCK = 12
_EIGENVALUES = 1e-9
"""Change of the eigenvalues, relative, from one block to the next, below which they are found: their errors are smaller still."""
_DEPENDENT = 1e-14
_MOST = 20
"""Blocks."""

Operator = Callable[[Array], Array]


def lowest_modes(mass: Operator, inverse: Operator, size: int, count: int) -> Array:
    """The `count` lowest modes (size, count) of a stiffness, by its `inverse`, and a `mass`: block Lanczos, orthogonalised in full.

    Fewer where the mass has a lower rank. Golub and Underwood, in Mathematical Software III (1977), 361.

    >>> stiffness = np.arange(1.0, 41.0)[:, None]
    >>> found = lowest_modes(lambda x: x, lambda x: x / stiffness, 40, 3)
    >>> np.abs(found).round(6).argmax(axis=0).tolist()
    [0, 1, 2]
    """
    block = np.random.default_rng(0).standard_normal((size, min(size, _BLOCK)))
    vectors, momenta, projected = np.zeros((size, 0)), np.zeros((size, 0)), np.zeros((0, 0))
    before, weights = np.zeros(0), np.zeros((0, 0))
    for _ in range(_MOST):
        block, momentum = _orthonormal(block, mass(block), vectors, momenta)
        if not block.shape[1]:
            break
        vectors, momenta = np.hstack([vectors, block]), np.hstack([momenta, momentum])
        block = inverse(momentum)
        rows = momenta.T @ block
        projected = np.hstack([np.vstack([projected, rows[: projected.shape[0]].T]), rows])
        values, weights = np.linalg.eigh(0.5 * (projected + projected.T))
        now = values[::-1][:count]
        if len(now) == len(before) == count and np.all(np.abs(now - before) <= _EIGENVALUES * now):
            break
        before = now
    return vectors @ weights[:, ::-1][:, :count]


def _orthonormal(block: Array, momentum: Array, vectors: Array, momenta: Array) -> tuple[Array, Array]:
    """A block with its momenta, orthonormal in mass, to earlier vectors too; less what depends on these."""
    scale = np.sqrt(np.einsum("ij,ij->j", block, momentum))
    kept = scale > 0.0
    block, momentum = block[:, kept] / scale[kept], momentum[:, kept] / scale[kept]
    for _ in range(2):
        share = momenta.T @ block
        block, momentum = block - vectors @ share, momentum - momenta @ share
        values, turn = np.linalg.eigh(block.T @ momentum)
        large = values > _DEPENDENT
        turn = turn[:, large] / np.sqrt(values[large])
        block, momentum = block @ turn, momentum @ turn
    return block, momentum
