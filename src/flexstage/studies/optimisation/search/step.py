"""One step of a search in the convex model around a design. Eigenvalue constraints are replaced by cutting planes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.studies.optimisation.search.problem import Linear, Problem, Weights, linear, second_order_correction, sides
from flexstage.studies.optimisation.search.quadratic import quadratic
from flexstage.studies.optimisation.values import Point

_SOFT = 1e-2
"""Additional curvature of objective and violation, which makes the model strictly convex. Its effect vanishes with the step."""
_CUTS = 12
_CLOSE = 1e-10
_SAME = 9


@dataclass(frozen=True, eq=False)
class Step:
    """Result of one step: the `change` (n,) of the design in fractions of the ranges, and the multipliers `weights` of all sides.

    `gain` is the predicted improvement of the merit function (objective plus `penalty` times violation); `excess` is the predicted
    remaining violation of limits.
    """

    change: Array
    gain: float
    excess: float
    weights: tuple[Weights, ...]
    held: bool
    """Whether the trust region limited the step."""


@dataclass(eq=False)
class _Rows:
    """Planes of the model: constant + gradient d <= t (objective) or s (limits); `owners` are a side and a piece or vector."""

    constants: list[float]
    gradients: list[Array]
    aims: list[bool]
    owners: list[tuple[int, int | Array]]

    def add(self, side: int, piece: int | Array, constant: float, gradient: Array, *, level: float | None) -> None:
        """Add a plane of a side: a limit's, or with its `level` the objective's."""
        self.owners.append((side, piece))
        self.constants.append(constant - (level or 0.0))
        self.gradients.append(gradient)
        self.aims.append(level is not None)


@dataclass(frozen=True)
class Bounds:
    """Largest step, in fractions of the ranges, and the penalty per unit violation."""

    radius: float
    penalty: float


def step(problem: Problem, point: Point, hessian: Array, bounds: Bounds, tried: Point | None = None) -> Step:
    """Minimise t + d^T B d / 2 + penalty s over all changes d of the design; B is the `hessian`.

    The changes are limited by the trust radius and the ranges. To first order, t is an upper bound of the objective's increase, and s >= 0
    is an upper bound of the violation of every limit. Sides of frequencies are matrices. The eigenvectors of the changed matrices define
    additional planes until no eigenvalue exceeds t (objective) or s (limits). This method of planes is exact even for crossing modes. If a
    design was `tried`, the planes are shifted so that they match its values (second-order correction). Without such shifts, the steps along
    curved limits would be short.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> from flexstage.studies.optimisation.setting import setting
    >>> found = setting(*leaf_study())
    >>> step(found.problem, found.before, np.eye(1), Bounds(0.1, 10.0)).change.round(3).tolist()
    [0.1]
    """
    models = [linear(side, point) if tried is None else second_order_correction(side, point, tried) for side in sides(problem)]
    radius, penalty = bounds.radius, bounds.penalty
    level = problem.worth(point)
    rows = _initial_planes(problem, models, level, radius)
    low, high = np.maximum(-point.shares, -radius), np.minimum(1.0 - point.shares, radius)
    found, multipliers = _solve(rows, hessian, low, high, penalty)
    for _ in range(_CUTS):
        if not _add_planes(problem, models, rows, found, level):
            break
        found, multipliers = _solve(rows, hessian, low, high, penalty)
    size = len(point.shares)
    change, rise, excess = found[:size], float(found[size]), float(found[size + 1])
    merit = rise + 0.5 * float(change @ hessian @ change) + penalty * (excess - problem.violation(point))
    held = bool(np.any(np.abs(change) >= 0.999 * radius))
    return Step(change, -merit, excess, _weights(models, rows, multipliers), held)


def _initial_planes(problem: Problem, models: list[Linear], level: float, radius: float) -> _Rows:
    """Planes that can be active within the radius, each once; of matrices, those of the present modes."""
    rows = _Rows([], [], [], [])
    for number, model in enumerate(models):
        aim = number < len(problem.objective)
        if not model.diagonal:
            for own in np.eye(len(model.constant)):
                rows.add(number, own, *model.project(own), level=level if aim else None)
            continue
        reach = radius * np.sum(np.abs(model.slope), axis=0)
        near = model.constant + reach >= (np.max(model.constant - reach) if aim else 0.0)
        keys = np.round(np.column_stack([model.constant, model.slope.T]), _SAME)
        first = np.unique(keys, axis=0, return_index=True)[1]
        for piece in sorted(int(each) for each in first if near[each]):
            rows.add(number, piece, float(model.constant[piece]), model.slope[:, piece], level=level if aim else None)
    return rows


def _solve(rows: _Rows, hessian: Array, low: Array, high: Array, penalty: float) -> tuple[Array, Array]:
    """The model's minimiser (d, t, s) and the multipliers of its planes."""
    size = len(hessian)
    whole = np.zeros((size + 2, size + 2))
    whole[:size, :size] = hessian
    whole[size, size] = whole[size + 1, size + 1] = _SOFT
    unit = np.eye(size + 2)
    aims = np.array(rows.aims, dtype=bool)
    planes = np.column_stack([np.array(rows.gradients).reshape(-1, size), -aims.astype(float), -(~aims).astype(float)])
    normals = np.vstack([planes, unit[:size], -unit[:size], -unit[size + 1]])
    bounds = np.concatenate([-np.array(rows.constants), high, -low, [0.0]])
    found = quadratic(whole, np.concatenate([np.zeros(size), [1.0, penalty]]), normals, bounds)
    return found.at, found.multipliers[: len(aims)]


def _add_planes(problem: Problem, models: list[Linear], rows: _Rows, found: Array, level: float) -> bool:
    """Add the eigenvectors whose eigenvalue after the change is above t or s; return whether there were any."""
    size, added = len(found) - 2, False
    for number, model in enumerate(models):
        if model.diagonal:
            continue
        aim = number < len(problem.objective)
        ceiling = float(found[size]) + level if aim else float(found[size + 1])
        values, vectors = model.after(found[:size])
        for value, vector in zip(values, vectors.T, strict=True):
            if value > ceiling + _CLOSE:
                rows.add(number, vector, *model.project(vector), level=level if aim else None)
                added = True
    return added


def _weights(models: list[Linear], rows: _Rows, multipliers: Array) -> tuple[Weights, ...]:
    """Multipliers of planes, collected by side."""
    totals = [np.zeros(model.constant.shape) for model in models]
    for (number, own), value in zip(rows.owners, multipliers, strict=True):
        if isinstance(own, int):
            totals[number][own] += value
        else:
            totals[number] += value * np.outer(own, own)
    return tuple(Weights(each) for each in totals)
