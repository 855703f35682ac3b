"""Interactions of two variables: the fraction of a response's variance that they explain only together, and the interaction's shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np

from flexstage.base.number import Array

_LEVELS = 3
_WIDEST = 8
_FEWEST = 8
_LEAST, _MOST = 0.01, 4
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Interaction:
    """Interaction of two variables: the mean response over the first variable, for low, middle and high values of the second variable.

    `over`, `by` and `response` are the indices of both variables and of the response. `share` is the fraction of the response's variance
    that only both variables together explain. `places` (b,) are the mean values [SI] of the first variable in b bins. `levels` (3,) are the
    mean values [SI] of the second variable at its three levels. `means` (3, b) are the means of the response; they are NaN for combinations
    without a design.
    """

    over: int
    by: int
    response: int
    share: float
    places: Array
    levels: Array
    means: Array


def paired_shares(at: Array, values: Array, *, grid: bool) -> Array:
    """Compute the fractions (d, d, r) of the variance of responses (n, r) that pairs of the variables `at` (n, d) explain only together.

    The method is analysis of variance: variables are divided into bins (levels of a `grid`). The effects of all single bins are fitted and
    subtracted. The cells formed by the bins of two variables i and j then explain a sum of squares SS_ij of the residual. The fraction is
    SS_ij divided by the total sum of squares. Without a `grid`, the value of SS_ij expected without interaction is first subtracted. It is
    (b_i - 1)(b_j - 1) MSE, with the numbers of bins b_i and b_j and the mean square MSE of the rest of the residual. For a complete grid,
    the fraction is exact. Without a grid, the computed fractions omit effects within bins, and are therefore too small. The result is NaN
    on the diagonal, for too few designs, and for a constant response.

    >>> from itertools import product
    >>> at = np.array(list(product([-1.0, 0.0, 1.0], repeat=2)))
    >>> paired_shares(at, at[:, :1] * at[:, 1:], grid=True)[0, 1].round(6).tolist()  # a product has only interaction
    [1.0]
    >>> paired_shares(at, at[:, :1] + at[:, 1:], grid=True)[0, 1].round(6).tolist()
    [0.0]
    """
    count, dimensions = at.shape
    result = np.full((dimensions, dimensions, values.shape[1]), np.nan)
    width = _WIDEST if grid else min(_WIDEST, int(np.sqrt(count / _FEWEST)))
    if width < 2 or count < 2:
        return result
    bins = [np.unique(column, return_inverse=True)[1] if grid else rank_bins(column, width) for column in at.T]
    residual = values - values.mean(axis=0) - sum(effect[group] for effect, group in zip(single_effects(bins, values), bins, strict=True))
    total, left = count * variance(values), np.sum(residual**2, axis=0)
    singles = sum(int(group.max()) for group in bins) + 1
    for first, second in combinations(range(dimensions), 2):
        explained = _explained_sum(bins[first], bins[second], residual)
        degrees = int(bins[first].max()) * int(bins[second].max())
        spare = count - singles - degrees
        chance = 0.0 if grid else degrees * (left - explained) / spare if spare > 0 else np.nan
        result[first, second] = result[second, first] = np.maximum((explained - chance) / total, 0.0)
    return result


def variance(values: Array) -> Array:
    """Compute the variance (r,) of responses (n, r). The variance is NaN for relative variations below 1e-9, which are rounding errors.

    >>> variance(np.array([[1.0, 2.0], [3.0, 2.0]])).tolist()
    [1.0, nan]
    """
    if not len(values):
        return np.full(values.shape[1], np.nan)
    return np.where(np.ptp(values, axis=0) > _ROUNDING * np.abs(values).max(axis=0), np.var(values, axis=0), np.nan)


def rank_bins(column: Array, count: int) -> Array:
    """Assign each value (n,) to one of `count` bins with equal counts.

    >>> rank_bins(np.array([0.3, 0.1, 0.2, 0.9]), 2).tolist()
    [1, 0, 0, 1]
    """
    rank = np.argsort(np.argsort(column, kind="stable"), kind="stable")
    return rank * count // max(len(column), 1)


def single_effects(bins: Sequence[Array], values: Array) -> list[Array]:
    """Estimate the effect (b, r) of each bin of a variable on responses (n, r), relative to the mean response.

    `bins` contains the bin numbers (n,) of the designs for each variable. One least-squares problem for all variables separates their
    effects, even for few designs. Empty bins have effect 0.

    >>> bins = [np.array([0, 0, 0, 1]), np.array([0, 0, 1, 1])]
    >>> [each[1] - each[0] for each in single_effects(bins, np.array([[1.0], [1.0], [3.0], [3.0]]))][0].round(9).tolist()
    [0.0]
    """
    starts = np.cumsum([0, *(int(group.max()) + 1 for group in bins)])
    places = [group + start for group, start in zip(bins, starts[:-1], strict=True)]
    size = int(starts[-1])
    normal = np.zeros((size, size))
    for first in places:
        for second in places:
            normal += np.bincount(first * size + second, minlength=size * size).reshape(size, size)
    centred = values - values.mean(axis=0)
    sums = np.stack([sum(np.bincount(place, column, size) for place in places) for column in centred.T], axis=-1)
    effects = np.linalg.lstsq(normal, sums, rcond=None)[0]
    parts = [effects[start:end] for start, end in pairwise(starts)]
    return [part - part[group].mean(axis=0) for part, group in zip(parts, bins, strict=True)]


def _explained_sum(first: Array, second: Array, residual: Array) -> Array:
    """Sum of squares (r,) of the cells' means."""
    cells = first * (int(second.max()) + 1) + second
    counts = np.bincount(cells)
    sums = np.stack([np.bincount(cells, column, len(counts)) for column in residual.T], axis=-1)
    return np.sum(np.divide(sums**2, counts[:, None], out=np.zeros_like(sums), where=counts[:, None] > 0), axis=0)


def second_order(blocks: Array, dimensions: int) -> tuple[Array, Array]:
    """Compute second-order Sobol indices (d, d, r) and their largest standard error (r,) from blocks (2 d + 2, n, r) of Saltelli's plan.

    The second-order index of two variables x_i and x_j for a response y is S_ij = V[E(y | x_i, x_j)] / V(y) - S_i - S_j, with their
    first-order indices S_i and S_j. It follows from products of the responses of two designs that have only x_i and x_j in common. With the
    samples A and B of `Plan`, these designs are A with column j of B, and B with column i of A (Saltelli, Computer Physics Communications
    145 (2002) 280). The mean response is subtracted first, and the results for (i, j) and (j, i) are averaged. Standard errors assume
    independent rows; the errors of a Sobol sequence are smaller.

    >>> second_order(np.zeros((6, 4, 1)), 2)[0][0, 1].tolist()  # constant response
    [nan]
    """
    result = np.full((dimensions, dimensions, blocks.shape[-1]), np.nan)
    errors = np.full(blocks.shape[-1], np.nan)
    if not blocks.shape[1]:
        return result, errors
    centre, spread = blocks[:2].mean(axis=(0, 1)), variance(blocks[:2].reshape(-1, blocks.shape[-1]))
    first, second, mixed, turned = (part - centre for part in (blocks[0], blocks[1], blocks[2 : dimensions + 2], blocks[dimensions + 2 :]))
    single = 0.5 * (second * (mixed - first) + first * (turned - second))
    for one, two in combinations(range(dimensions), 2):
        both = 0.5 * (turned[one] * mixed[two] + turned[two] * mixed[one]) - first * second
        rows = (both - single[one] - single[two]) / spread
        result[one, two] = result[two, one] = rows.mean(axis=0)
        errors = np.fmax(errors, standard_error(rows))
    return result, errors


def standard_error(rows: Array) -> Array:
    """Compute the standard error (..., r) of the mean over independent rows (..., n, r).

    >>> standard_error(np.array([[1.0], [3.0]])).tolist()
    [1.0]
    """
    count = rows.shape[-2]
    return np.std(rows, axis=-2, ddof=1) / np.sqrt(count) if count > 1 else np.full((*rows.shape[:-2], rows.shape[-1]), np.nan)


def strongest(at: Array, values: Array, shares: Array, *, grid: bool) -> tuple[Interaction, ...]:
    """Select the strongest interactions, at most four; every interaction explains at least 1 % of a response's variance.

    `at` (n, d) are the variables, `values` (n, r) the responses, `shares` (d, d, r) the results of `paired_shares`.

    >>> from itertools import product
    >>> at = np.array(list(product([-1.0, 0.0, 1.0], repeat=2)))
    >>> found = strongest(at, at[:, :1] * at[:, 1:], np.ones((2, 2, 1)), grid=True)[0]
    >>> found.means.tolist()  # decreasing for a low, increasing for a high other variable
    [[1.0, 0.0, -1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 1.0]]
    """
    upper = [(pair, number) for pair in combinations(range(at.shape[1]), 2) for number in range(values.shape[1])]
    strong = [(float(shares[*pair, number]), pair, number) for pair, number in upper if shares[*pair, number] >= _LEAST]
    return tuple(
        _interaction(at, values[:, number], pair, share, number, grid=grid) for share, pair, number in sorted(strong, reverse=True)[:_MOST]
    )


def _interaction(at: Array, values: Array, pair: tuple[int, int], share: float, number: int, *, grid: bool) -> Interaction:
    over, by = pair
    width = max(2, min(_WIDEST, len(at) // (_FEWEST * _LEVELS)))
    along = np.unique(at[:, over], return_inverse=True)[1] if grid else rank_bins(at[:, over], width)
    levels = np.unique(at[:, by], return_inverse=True)[1] if grid else rank_bins(at[:, by], _LEVELS)
    level = levels * _LEVELS // (int(levels.max()) + 1)
    width = int(along.max()) + 1
    cells = level * width + along
    means = _means(cells, values, _LEVELS * width).reshape(_LEVELS, width)
    return Interaction(over, by, number, share, _means(along, at[:, over], width), _means(level, at[:, by], _LEVELS), means)


def _means(groups: Array, values: Array, count: int) -> Array:
    counts = np.bincount(groups, minlength=count)
    return np.divide(np.bincount(groups, values, count), counts, out=np.full(count, np.nan), where=counts > 0)
