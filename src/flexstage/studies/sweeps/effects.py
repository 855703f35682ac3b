"""Effects of variables on responses: distributions, main effects, Sobol indices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.studies.sweeps.execution.store import Results
from flexstage.studies.sweeps.interactions import (
    Interaction,
    paired_shares,
    rank_bins,
    second_order,
    single_effects,
    standard_error,
    strongest,
    variance,
)
from flexstage.studies.sweeps.plan import Plan, Sampling

_BINS = 16
_FEWEST = 8
_SPARE = 4
"""Smallest number of designs in a bin."""


@dataclass(frozen=True, eq=False)
class Effects(InNotebook):
    """Effects of d variables on r responses, computed from the designs that have values.

    Of `computed` designs, `used` have values. `mean`, `deviation`, `low` and `high` (r,) are the mean, standard deviation, minimum and
    maximum of each response in SI. `means` (d, b, r) contains, for each variable, the mean response in each of b bins of its values;
    `places` (d, b) are the mean values of the variable in these bins. The bins have equal counts; for grids, each level is a bin. The
    effects of the other variables are subtracted from `means`. `first` (d, r) is the fraction of the variance due to a variable alone. For
    Saltelli's plan, it is Sobol's first-order index; for other plans, it is the correlation ratio of the bins. For random designs, this
    ratio is corrected for the number of bins. `total` (d, r) is the fraction due to a variable and all its interactions; it is None for
    plans other than Saltelli's. `pairs` (d, d, r) is the fraction that two variables explain only together; `strongest` are the strongest
    interactions. `errors` (2, r) contains the largest standard error of first-order and total indices, and of second-order indices; it is
    NaN for plans other than Saltelli's. All fractions are NaN for a constant response.
    """

    variables: tuple[str, ...]
    responses: tuple[str, ...]
    used: int
    computed: int
    mean: Array
    deviation: Array
    low: Array
    high: Array
    places: Array
    means: Array
    first: Array
    total: Array | None
    pairs: Array
    errors: Array
    strongest: tuple[Interaction, ...]
    method: str


@check_arguments
def effects(results: Results, plan: Plan) -> Effects:
    """Compute the effects of a study's variables on its responses, from the computed designs that have values of all responses.

    For a response y and a variable x_i, the first-order index is S_i = V[E(y | x_i)] / V(y), and the total index is T_i = E[V(y | x_~i)] /
    V(y). E is the expected value, V the variance, and x_~i are all variables but x_i (Sobol, Math. Comput. Simul. 55 (2001) 271; estimators
    of Saltelli et al. 2010). With too few designs, the effects are NaN.

    >>> plan = Plan(Sampling.GRID, 2, levels=(3, 3))
    >>> from flexstage.studies.sweeps.plan import shares
    >>> at = shares(plan, 0, 9)
    >>> names, units = (("a", "b"), ("y",)), (("m", "m"), ("Hz",))
    >>> made = Results(np.arange(9), at, 3.0 * at[:, :1] + 4.0 * at[:, 1:], {}, names, units, 9, {}, "")
    >>> found = effects(made, plan)
    >>> found.means[0, :, 0].round(6).tolist(), found.first[:, 0].round(6).tolist()
    ([2.0, 3.5, 5.0], [0.36, 0.64])
    """
    sound = np.all(np.isfinite(results.responses), axis=1)
    at, values = results.variables[sound], results.responses[sound]
    bins = [_bins(column, plan) for column in at.T]
    width = max((int(group.max(initial=0)) + 1 for group in bins), default=1)
    places, means = np.full((at.shape[1], width), np.nan), np.full((at.shape[1], width, values.shape[1]), np.nan)
    for number, (group, effect) in enumerate(zip(bins, single_effects(bins, values) if len(values) else [], strict=False)):
        count = int(group.max()) + 1
        places[number, :count] = np.bincount(group, at[:, number]) / np.bincount(group)
        means[number, :count] = values.mean(axis=0) + effect
    grid = plan.sampling is Sampling.GRID
    error = np.full(values.shape[1], np.nan)
    total, first, method = None, _ratios(bins, values, grid=grid), "correlation ratio of bins"
    if plan.sampling is Sampling.SALTELLI:
        blocks = _complete_blocks(results, plan)
        first, total, error = _sobol(blocks, plan.dimensions)
        method = f"Sobol indices from {blocks.shape[1]} of {plan.count} rows of Saltelli's plan"
    pairs, further = _pairs(results, plan, sound)
    return Effects(
        *results.names,
        len(values),
        len(sound),
        *(_reduce(each, values) for each in (np.mean, np.std, np.min, np.max)),
        places=places,
        means=means,
        first=first,
        total=total,
        pairs=pairs,
        errors=np.stack([error, further]),
        strongest=strongest(at, values, pairs, grid=grid),
        method=method,
    )


def _reduce(operation: object, values: Array) -> Array:
    return operation(values, axis=0) if len(values) else np.full(values.shape[1], np.nan)  # type: ignore[operator]


def _bins(column: Array, plan: Plan) -> Array:
    """The bin (n,) of each value: levels of a grid, else bins of equal counts."""
    if plan.sampling is Sampling.GRID:
        return np.unique(column, return_inverse=True)[1]
    count = max(1, min(_BINS, len(column) // _FEWEST, 1 + len(column) // (_SPARE * plan.dimensions)))
    return rank_bins(column, count)


def _ratios(bins: list[Array], values: Array, *, grid: bool) -> Array:
    """Correlation ratios (d, r); of random designs less the expectation for random bins, (b - 1)/(n - 1); NaN for one bin."""
    result = np.full((len(bins), values.shape[1]), np.nan)
    if not len(values):
        return result
    spread = variance(values)
    for number, group in enumerate(bins):
        counts = np.bincount(group)
        sums = np.stack([np.bincount(group, weights=column) for column in values.T], axis=-1)
        between = np.sum(counts[:, None] * (sums / counts[:, None] - values.mean(axis=0)) ** 2, axis=0) / len(values)
        share = between / spread
        chance = 0.0 if grid or len(values) < 2 else (len(counts) - 1) / (len(values) - 1)
        result[number] = np.maximum((share - chance) / (1.0 - chance), 0.0) if chance < 1.0 and (grid or len(counts) > 1) else np.nan
    return result


def _sobol(blocks: Array, dimensions: int) -> tuple[Array, Array, Array]:
    """First-order and total indices (d, r) and their largest standard error (r,) of the blocks (d + 2 or more, n, r) of Saltelli's plan.

    S_i = E[f_B (f_AB,i - f_A)] / V, T_i = E[(f_A - f_AB,i)^2] / (2 V): estimators (b) and (f) of Table 2 of Saltelli et al., Computer
    Physics Communications 181 (2010) 259, after subtraction of the mean. NaN for a constant response.
    """
    if not blocks.shape[1]:
        unknown = np.full((dimensions, blocks.shape[-1]), np.nan)
        return unknown, unknown, unknown[0]
    first, second, *mixed = blocks[: dimensions + 2] - blocks[:2].mean(axis=(0, 1))
    spread, steps = variance(blocks[:2].reshape(-1, blocks.shape[-1])), np.stack(mixed) - first
    alone, total = second * steps / spread, 0.5 * steps**2 / spread
    error = np.max(np.concatenate([standard_error(alone), standard_error(total)]), axis=0)
    return alone.mean(axis=1), total.mean(axis=1), error


def _complete_blocks(results: Results, plan: Plan) -> Array:
    """Responses (blocks, n, r) of Saltelli's plan, of the sample rows whose designs are all complete."""
    values = np.full((plan.designs, results.responses.shape[1]), np.nan)
    values[results.designs] = results.responses
    blocks = values.reshape(plan.blocks, plan.count, -1)
    return blocks[:, np.all(np.isfinite(blocks), axis=(0, 2))]


def _pairs(results: Results, plan: Plan, sound: Array) -> tuple[Array, Array]:
    """Shares of pairs (d, d, r) and their largest standard error (r,).

    Second-order indices if the plan has them, else by analysis of variance over independent designs.
    """
    if plan.pairs:
        return second_order(_complete_blocks(results, plan), plan.dimensions)
    independent = sound & (results.designs < 2 * plan.count) if plan.sampling is Sampling.SALTELLI else sound
    shares = paired_shares(results.variables[independent], results.responses[independent], grid=plan.sampling is Sampling.GRID)
    return shares, np.full(results.responses.shape[1], np.nan)
