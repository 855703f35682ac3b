"""Effects of variables on responses: distributions, main effects, Sobol indices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.studies.study.plan import Plan, Sampling
from flexstage.studies.study.store import Results

_BINS = 16
_FEWEST = 8


@dataclass(frozen=True, eq=False)
class Effects:
    """What d variables do to r responses over the designs that have values.

    `used` designs of `computed`; `mean`, `deviation`, `low`, `high` (r,) in SI. `places` (d, b) and `means` (d, b, r): the mean response
    where a variable lies in each of b bins of equal counts (for grids, at each level): its main effect. `first` (d, r): share of the
    variance that a variable alone explains; `total` (d, r): with all its interactions; `total` is None unless the plan is Saltelli's,
    and `first` is then Sobol's, else the correlation ratio of the bins, corrected for their number. NaN where a response does not vary.
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
    method: str


def effects(results: Results, plan: Plan) -> Effects:
    """Effects of a study's variables on its responses, over all complete designs so far.

    First-order index S_i = V[E(y | x_i)] / V(y), total index T_i = E[V(y | x_~i)] / V(y) (Sobol, Math. Comput. Simul. 55 (2001) 271;
    estimators of Saltelli et al. 2010 by scipy). Raises nothing: what too few designs cannot tell is NaN.

    >>> plan = Plan(Sampling.GRID, 2, levels=(3, 3))
    >>> from flexstage.studies.study.plan import shares
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
    for number, group in enumerate(bins):
        for each in range(int(group.max(initial=-1)) + 1):
            members = group == each
            places[number, each], means[number, each] = at[members, number].mean(), values[members].mean(axis=0)
    total, first, method = None, _ratios(bins, values, grid=plan.sampling is Sampling.GRID), "correlation ratio of bins"
    if plan.sampling is Sampling.SALTELLI:
        first, total = _sobol(results, plan)
        method = "Sobol indices by Saltelli's plan"
    return Effects(
        *results.names,
        len(values),
        len(sound),
        *(_over(each, values) for each in (np.mean, np.std, np.min, np.max)),
        places=places,
        means=means,
        first=first,
        total=total,
        method=method,
    )


def _over(operation: object, values: Array) -> Array:
    return operation(values, axis=0) if len(values) else np.full(values.shape[1], np.nan)  # type: ignore[operator]


def _bins(column: Array, plan: Plan) -> Array:
    """Which bin (n,) each value falls into: levels of a grid, else bins of equal counts."""
    if plan.sampling is Sampling.GRID:
        return np.unique(column, return_inverse=True)[1]
    count = max(1, min(_BINS, len(column) // _FEWEST))
    rank = np.argsort(np.argsort(column, kind="stable"), kind="stable")
    return rank * count // max(len(column), 1)


def _ratios(bins: list[Array], values: Array, *, grid: bool) -> Array:
    """Correlation ratios (d, r); of random designs less what bins of pure chance would explain, (b - 1)/(n - 1)."""
    result = np.full((len(bins), values.shape[1]), np.nan)
    spread = np.var(values, axis=0) if len(values) else np.zeros(values.shape[1])
    varies = spread > 0.0
    for number, group in enumerate(bins):
        counts = np.bincount(group)
        sums = np.stack([np.bincount(group, weights=column) for column in values.T], axis=-1)
        between = np.sum(counts[:, None] * (sums / counts[:, None] - values.mean(axis=0)) ** 2, axis=0) / max(len(values), 1)
        share = np.divide(between, spread, out=np.full_like(spread, np.nan), where=varies)
        chance = 0.0 if grid or len(values) < 2 else (len(counts) - 1) / (len(values) - 1)
        result[number] = np.maximum((share - chance) / (1.0 - chance), 0.0) if chance < 1.0 else np.nan
    return result


def _sobol(results: Results, plan: Plan) -> tuple[Array, Array]:
    """Sobol indices (d, r) of a complete plan; NaN while designs are missing or have failed."""
    from scipy.stats import sobol_indices

    blocks, width = plan.dimensions + 2, results.responses.shape[1]
    unknown = np.full((plan.dimensions, width), np.nan)
    if not results.complete or not np.all(np.isfinite(results.responses)):
        return unknown, unknown
    by_block = results.responses.reshape(blocks, plan.count, width)
    varies = np.ptp(by_block[0], axis=0) > 0.0
    if not np.any(varies):
        return unknown, unknown
    values = by_block[..., varies]
    functions = {"f_A": values[0].T, "f_B": values[1].T, "f_AB": values[2:].transpose(0, 2, 1)}
    found = sobol_indices(func=functions, n=plan.count)
    first, total = unknown.copy(), unknown.copy()
    first[:, varies] = np.reshape(found.first_order.T, (plan.dimensions, -1))
    total[:, varies] = np.reshape(found.total_order.T, (plan.dimensions, -1))
    return first, total
