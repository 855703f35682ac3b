"""Binding limits of an optimum, and their sensitivities, which are Lagrange multipliers in SI units."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.analysis.assessment.requirements import Sense
from flexstage.studies.optimisation.result import Binding
from flexstage.studies.optimisation.search.problem import Problem, lagrangian
from flexstage.studies.optimisation.search.step import Bounds, Step, step
from flexstage.studies.optimisation.setting import Setting
from flexstage.studies.optimisation.values import Point

_COUNTS = 1e-5
_EDGE = 1e-7


def binding(setting: Setting, problem: Problem, point: Point) -> tuple[Binding, ...]:
    """Find the limits and the ends of variables' ranges that bind at an optimum, sorted by the effect of their relative changes.

    The multipliers come from a convex model with unit curvature around the optimum; the minimum of this model is the optimum itself. The
    multiplier of a limit c_i <= e_i is the derivative -d c_0 / d e_i of the minimum objective c_0. Multipliers are derivatives, and
    therefore valid for small changes only; for repeated modes, they are one-sided derivatives.
    """
    size = len(point.shares)
    model = step(problem, point, np.eye(size), Bounds(2.0, 1e4))
    objective = setting.definition.objectives[0]
    back = (-1.0 if objective.direction.sense is Sense.AT_LEAST else 1.0) * setting.scale(0)
    found = []
    for number, limit in enumerate(setting.kept):
        own = problem.limits[number]
        weight = model.weights[len(problem.objective) + number].total
        if weight > _COUNTS:
            rise = weight / own.scale if limit.sense is Sense.AT_LEAST else -weight / own.scale
            found.append(
                (
                    weight,
                    Binding(
                        f"{limit.key} {limit.text}",
                        limit.limit,
                        limit.quantity.si,
                        back * rise,
                        of_range=False,
                        objective_unit=objective.measure.quantity.si,
                    ),
                )
            )
    found += [(abs(slope), each) for slope, each in _ends(setting, problem, point, model, back)]
    return tuple(each for _, each in sorted(found, key=lambda item: -item[0]))


def _ends(setting: Setting, problem: Problem, point: Point, model: Step, back: float) -> Iterator[tuple[float, Binding]]:
    """Range ends at which the Lagrangian still decreases outward."""
    unit = setting.definition.objectives[0].measure.quantity.si
    slopes = lagrangian(problem, point, model.weights)
    assert slopes is not None  # noqa: S101  of one design, pieces correspond
    for number, variable in enumerate(setting.study.variables):
        share, slope = float(point.shares[number]), float(slopes[number])
        upper = share >= 1.0 - _EDGE and slope < -_COUNTS
        if not upper and not (share <= _EDGE and slope > _COUNTS):
            continue
        per_share = float(np.imag(variable.at(np.array(share + 1e-20j)))) / 1e-20
        limit = variable.high if upper else variable.low
        name = f"{variable.name} {'at most' if upper else 'at least'} (range)"
        yield slope, Binding(name, limit, variable.quantity.si, back * slope / per_share, of_range=True, objective_unit=unit)
