"""The lowest modes of large models by block Lanczos iteration: with one matrix factor, many vectors are solved in the time of a few."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array

_BLOCK = 12
_EIGENVALUES = 1e-9
"""Largest relative change of the eigenvalues between blocks at convergence; the errors of the eigenvalues are smaller."""
_DEPENDENT = 1e-14
_MOST = 20
"""Largest number of blocks."""

Operator = Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class Pencil:
    """The operators of an eigenvalue problem: `mass`, and `inverse` (of the stiffness), for vectors of length `size`."""

    mass: Operator
    inverse: Operator
    size: int


def lowest_modes(pencils: Sequence[Pencil], count: int) -> list[Array]:
    """Find the `count` lowest modes among all pencils by block Lanczos with full orthogonalisation; return modes (size, k) for each pencil.

    There are fewer modes if the total rank of the mass matrices is below `count`. Reference: Golub and Underwood, in Mathematical Software
    III (1977), 361.

    >>> stiffness = np.arange(1.0, 41.0)[:, None]
    >>> pencils = [Pencil(lambda x: x, lambda x: x / stiffness, 40), Pencil(lambda x: x, lambda x: x / (0.5 + stiffness), 40)]
    >>> [found.round(6).argmax(axis=0).tolist() for found in map(np.abs, lowest_modes(pencils, 5))]
    [[0, 1, 2], [0, 1]]
    """
    chains = [_Chain(pencil, -(-_BLOCK // len(pencils))) for pencil in pencils]
    before, owners = np.zeros(0), np.zeros(0, dtype=np.int64)
    for _ in range(_MOST):
        for chain in chains:
            chain.extend()
        values = np.concatenate([chain.values for chain in chains])
        order = np.argsort(-values, kind="stable")[:count]
        owners, now = np.repeat(np.arange(len(chains)), [len(chain.values) for chain in chains])[order], values[order]
        if len(now) == len(before) == count and np.all(np.abs(now - before) <= _EIGENVALUES * now):
            break
        before = now
    return [chain.modes(int(np.sum(owners == number))) for number, chain in enumerate(chains)]


class _Chain:
    """Blocks of one pencil, orthonormal in mass, and the `values` of the inverse on them, the largest first."""

    def __init__(self, pencil: Pencil, width: int) -> None:
        self.pencil, size = pencil, pencil.size
        self.block = np.random.default_rng(0).standard_normal((size, min(size, width)))
        self.vectors, self.momenta, self.projected = np.zeros((size, 0)), np.zeros((size, 0)), np.zeros((0, 0))
        self.values, self.weights = np.zeros(0), np.zeros((0, 0))

    def extend(self) -> None:
        """Add one block, if independent of the previous ones."""
        if not self.block.shape[1]:
            return
        block, momentum = _orthonormal(self.block, self.pencil.mass(self.block), self.vectors, self.momenta)
        self.block = block
        if not block.shape[1]:
            return
        self.vectors, self.momenta = np.hstack([self.vectors, block]), np.hstack([self.momenta, momentum])
        self.block = self.pencil.inverse(momentum)
        rows = self.momenta.T @ self.block
        self.projected = np.hstack([np.vstack([self.projected, rows[: len(self.projected)].T]), rows])
        values, weights = np.linalg.eigh(0.5 * (self.projected + self.projected.T))
        self.values, self.weights = values[::-1], weights[:, ::-1]

    def modes(self, count: int) -> Array:
        """The lowest modes."""
        return self.vectors @ self.weights[:, :count]


def _orthonormal(block: Array, momentum: Array, vectors: Array, momenta: Array) -> tuple[Array, Array]:
    """A block with its momenta, orthonormal in mass, also to earlier vectors; without dependent columns."""
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
