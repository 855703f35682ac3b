"""Plans of designs: points in the variables' ranges, independent of the sequence of computation."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import lru_cache

import numpy as np
import scipy

from flexstage.base.number import Array


class Sampling(Enum):
    """Method that distributes designs over the variables' ranges."""

    GRID = "grid"
    LATIN_HYPERCUBE = "latin hypercube"
    SOBOL = "sobol"
    SALTELLI = "saltelli"
    MONTE_CARLO = "monte carlo"


@dataclass(frozen=True)
class Plan:
    """A sampling of `count` designs with its `seed`. A grid has `levels` instead of a count: the number of values of each variable.

    Saltelli's plan contains two Sobol samples A and B of `count` designs each. For each of d variables, the plan also contains A with this
    variable's column from B. Saltelli's plan therefore has count (d + 2) designs, for Sobol indices (Saltelli et al., Computer Physics
    Communications 181 (2010) 259). With `pairs`, Saltelli's plan also contains, for each variable, B with this variable's column from A.
    It then has count (2 d + 2) designs, for second-order indices.
    """

    sampling: Sampling
    dimensions: int
    count: int = 0
    levels: tuple[int, ...] = ()
    seed: int = 0
    pairs: bool = False

    @property
    def blocks(self) -> int:
        """Number of samples, each of `count` designs, in Saltelli's plan.

        >>> Plan(Sampling.SALTELLI, 3, count=8).blocks, Plan(Sampling.SALTELLI, 3, count=8, pairs=True).blocks
        (5, 8)
        """
        return (2 if self.pairs else 1) * self.dimensions + 2

    @property
    def designs(self) -> int:
        """Number of designs.

        >>> Plan(Sampling.GRID, 2, levels=(3, 4)).designs, Plan(Sampling.SALTELLI, 2, count=8).designs
        (12, 32)
        """
        if self.sampling is Sampling.GRID:
            return int(np.prod(self.levels, dtype=object))
        return self.count * self.blocks if self.sampling is Sampling.SALTELLI else self.count


def shares(plan: Plan, start: int, stop: int) -> Array:
    """Compute fractions (stop - start, d) of the ranges, 0 to 1, for designs `start` to `stop` (excluded).

    >>> shares(Plan(Sampling.GRID, 2, levels=(3, 2)), 0, 6).tolist()
    [[0.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 1.0], [1.0, 0.0], [1.0, 1.0]]
    >>> whole, plan = shares(Plan(Sampling.SOBOL, 2, count=8, seed=3), 0, 8), Plan(Sampling.SOBOL, 2, count=8, seed=3)
    >>> bool(np.all(whole[5:7] == shares(plan, 5, 7)))
    True
    """
    if plan.sampling is Sampling.GRID:
        places = np.unravel_index(np.arange(start, stop), plan.levels)
        return np.stack([place / (levels - 1) for place, levels in zip(places, plan.levels, strict=True)], axis=-1)
    if plan.sampling is Sampling.LATIN_HYPERCUBE:
        return _latin(plan, start, stop)
    if plan.sampling is Sampling.MONTE_CARLO:
        return _random(plan, start, stop)
    if plan.sampling is Sampling.SOBOL:
        return _sobol(plan.dimensions, plan.seed, start, stop)
    return _saltelli(plan, start, stop)


def _random(plan: Plan, start: int, stop: int) -> Array:
    """Independent random designs: the generator takes one step for each number, so that any piece is accessible by stepping ahead."""
    bits = np.random.PCG64(plan.seed)
    bits.advance(start * plan.dimensions)
    return np.random.Generator(bits).random((stop - start, plan.dimensions))


def _sobol(dimensions: int, seed: int, start: int, stop: int) -> Array:
    """Rows of a scrambled Sobol sequence."""
    sequence = scipy.stats.qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed))
    if start:
        sequence.fast_forward(start)
    return _draw(sequence, stop - start)


def _draw(sequence: object, count: int) -> Array:
    """Rows in powers of two: the sequence warns of other numbers, but the plan does not need balanced pieces."""
    rows = [np.zeros((0, sequence.d))]  # type: ignore[attr-defined]
    while count:
        piece = 1 << (count.bit_length() - 1)
        rows.append(sequence.random(piece))  # type: ignore[attr-defined]
        count -= piece
    return np.concatenate(rows)


def _latin(plan: Plan, start: int, stop: int) -> Array:
    """Each variable's range in `count` equal strata, each used once, in a random order, at a random point of the stratum."""
    return np.stack([_strata(plan.count, plan.seed, number)[start:stop] for number in range(plan.dimensions)], axis=-1)


@lru_cache(maxsize=64)
def _strata(count: int, seed: int, number: int) -> Array:
    """One variable's shares of all designs: cached for all pieces of the plan."""
    generator = np.random.default_rng([seed, number])
    return (generator.permutation(count) + generator.random(count)) / count


def _saltelli(plan: Plan, start: int, stop: int) -> Array:
    """Designs block by block: A, B, then A with one column of B each, then B with one column of A each."""
    result = np.empty((stop - start, plan.dimensions))
    for block in range(start // plan.count, -(-stop // plan.count)):
        low, high = max(start, block * plan.count), min(stop, (block + 1) * plan.count)
        both = _sobol(2 * plan.dimensions, plan.seed, low - block * plan.count, high - block * plan.count)
        first, second = both[:, : plan.dimensions], both[:, plan.dimensions :]
        turned = block == 1 or block >= plan.dimensions + 2
        rows, other = (second.copy(), first) if turned else (first.copy(), second)
        if block > 1:
            column = (block - 2) % plan.dimensions
            rows[:, column] = other[:, column]
        result[low - start : high - start] = rows
    return result
