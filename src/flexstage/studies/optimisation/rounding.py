"""Rounding of an optimum to the manufacturing steps of the variables."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from flexstage.base.number import Array
from flexstage.studies.optimisation.result import Rounded
from flexstage.studies.optimisation.search.problem import SPARE, Problem
from flexstage.studies.optimisation.setting import Setting, share_of
from flexstage.studies.optimisation.values import Point, values_of

_TRIED, _BATCH = 64, 16
_ALL = 12
_ROUNDS = 5
_EDGE = 1e-9


def round_to_steps(setting: Setting, problem: Problem, point: Point) -> Rounded | None:
    """Near `point`, find the best feasible design with variables at multiples of their steps. Returns `None` if no variable has a step.

    In a neighbour of `point`, each variable with a step has the multiple of its step below or above its value. Of more than 12 such
    variables, the further ones have the nearest multiple only. Neighbours are ranked by the linear model of objective and limits. They are
    evaluated in batches, best rank first, until one is feasible. Then single steps of every variable are tried as long as they improve the
    design. Variables without a step are constant.
    """
    stepped = [number for number, each in enumerate(setting.study.variables) if each.step is not None]
    if not stepped:
        return None
    ranked = _rank(problem, point, _neighbours(setting, point, stepped))[:_TRIED]
    best, tried = None, 0
    for first in range(0, len(ranked), _BATCH):
        best = _best(problem, setting, ranked[first : first + _BATCH])
        tried += len(ranked[first : first + _BATCH])
        if best is not None:
            break
    if best is None:
        reason = f"none of the {tried} nearest designs at multiples of the steps is feasible; use finer steps, or wider limits"
        return Rounded(None, None, np.nan, tried, reason)
    for _ in range(_ROUNDS):
        around = np.array(list(_single_steps(setting, best, stepped)))
        better = _best(problem, setting, around) if len(around) else None
        tried += len(around)
        if better is None or problem.worth(better) >= problem.worth(best) - _EDGE:
            break
        best = better
    loss = (problem.worth(best) - problem.worth(point)) * setting.scale(0)
    return Rounded(best, values_of(setting.study, best.shares), loss, tried)


def _neighbours(setting: Setting, point: Point, stepped: list[int]) -> Array:
    """Shares (k, n) of designs whose stepped variables are on the multiples below or above."""
    choices = [_multiples(setting, point, number) for number in stepped]
    if len(stepped) > _ALL:
        choices = [own if number < _ALL else own[:1] for number, own in enumerate(choices)]
    rows = []
    for picked in itertools.product(*choices):
        shares = point.shares.copy()
        shares[stepped] = picked
        rows.append(shares)
    return np.reshape(rows, (-1, len(point.shares)))


def _multiples(setting: Setting, point: Point, number: int) -> list[float]:
    """Shares of the multiples of the step below and above, the nearest first; within the range."""
    variable = setting.study.variables[number]
    assert variable.step is not None  # noqa: S101  the variable has a step
    count = float(np.real(variable.at(np.asarray(point.shares[number])))) / variable.step
    whole = {int(np.floor(count + 1e-6)), int(np.ceil(count - 1e-6))}
    found = [share_of(variable, each * variable.step) for each in sorted(whole, key=lambda each: abs(each - count))]
    return [share for share in found if -_EDGE <= share <= 1.0 + _EDGE]


def _rank(problem: Problem, point: Point, neighbours: Array) -> Array:
    """Neighbours by the linear model: feasible ones first, then by objective."""
    moves = neighbours - point.shares
    values = point.values[None] + moves @ point.gradient.T
    worth = np.array([max(side.of(row[side.index]) for side in problem.objective) for row in values])
    excess = np.array([max((side.of(row[side.index]) for side in problem.limits), default=0.0) for row in values])
    return neighbours[np.lexsort([worth + 10.0 * np.maximum(excess, 0.0), excess > 0.0])]


def _best(problem: Problem, setting: Setting, shares: Array) -> Point | None:
    """The best of some designs that is feasible."""
    found = [point for point in setting.values.evaluate(shares) if isinstance(point, Point)]
    kept = [point for point in found if problem.excess(point) <= SPARE]
    return min(kept, key=problem.worth, default=None)


def _single_steps(setting: Setting, best: Point, stepped: list[int]) -> Iterator[Array]:
    """Designs one step of one variable away."""
    for number in stepped:
        variable = setting.study.variables[number]
        assert variable.step is not None  # noqa: S101
        value = float(np.real(variable.at(np.asarray(best.shares[number]))))
        for change in (-variable.step, variable.step):
            share = share_of(variable, round((value + change) / variable.step) * variable.step)
            if -_EDGE <= share <= 1.0 + _EDGE:
                shares = best.shares.copy()
                shares[number] = share
                yield shares
