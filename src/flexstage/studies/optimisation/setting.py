"""Set-up of an optimisation: measures, their sides and scales, the nominal design, the starts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.analysis.assessment.judge import bench_of, value_or_reason
from flexstage.analysis.assessment.measures import Measure
from flexstage.analysis.assessment.requirements import Requirement, Sense
from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.mechanism.addresses.address import get
from flexstage.mechanism.checks import require_valid
from flexstage.studies.optimisation.problem import Objective, OptimisationProblem, limits
from flexstage.studies.optimisation.search.problem import SPARE, Problem, Side
from flexstage.studies.optimisation.values import Point, Values
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.variable import Variable

_EDGE = 1e-9


@dataclass(frozen=True, eq=False)
class Setting:
    """Input of a search. `values` evaluates the objectives, then the measures of the limits `kept`. `before` is the nominal design."""

    study: Study
    definition: OptimisationProblem
    kept: tuple[Requirement, ...]
    values: Values
    before: Point

    @property
    def problem(self) -> Problem:
        """The problem with the first objective and all limits."""
        return Problem((self.objective(0),), tuple(self.side(number) for number in range(len(self.kept))))

    def objective(self, number: int) -> Side:
        """Return an objective as a side: c is value / scale for an objective to minimise, -value / scale for one to maximise."""
        return Side(number, self.definition.objectives[number].direction.sense, 0.0, self.scale(number))

    def scale(self, number: int) -> float:
        """Return the scale of an objective: its value in the nominal design."""
        return abs(float(self.before.values[number])) or 1.0

    def side(self, number: int) -> Side:
        """Return a limit as a side, with a small margin."""
        limit = self.kept[number]
        index = len(self.definition.objectives) + number
        scale = abs(limit.limit) or abs(float(self.before.values[index])) or 1.0
        spare = SPARE * scale
        return Side(index, limit.sense, limit.limit + (spare if limit.sense is Sense.AT_LEAST else -spare), scale)

    def starts(self) -> Array:
        """Return the initial designs (starts, n) as fractions of the ranges: the nominal design, then a scrambled Sobol sequence."""
        count, size = self.definition.starts - 1, len(self.study.variables)
        generator = scipy.stats.qmc.Sobol(size, scramble=True, rng=np.random.default_rng(self.definition.seed))
        drawn = generator.random(1 << max(count - 1, 0).bit_length())[:count]
        return np.concatenate([self.before.shares[None], drawn])

    @property
    def idle(self) -> tuple[str, ...]:
        """Variables that, at the nominal design, have no effect on any measure."""
        largest = np.max(np.abs(self.before.gradient) / np.maximum(np.abs(self.before.values), 1e-300)[:, None], axis=0)
        return tuple(each.name for each, most in zip(self.study.variables, largest, strict=True) if most <= 1e-14)


def setting(study: Study, definition: OptimisationProblem) -> Setting:
    """Set up an optimisation, and evaluate the nominal design.

    Raises `DesignError` for measures that the stage does not have, nominal values outside their ranges, and an invalid nominal design.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> found = setting(*leaf_study())
    >>> found.before.shares.round(3).tolist(), round(found.before.values[0])
    ([0.286], 875)
    """
    kept = limits(study, definition)
    measures = (*(each.measure for each in definition.objectives), *kept)
    require(_measure_findings(study, definition.objectives, kept))
    require(_range_findings(study))
    values = Values(study, tuple(measures))
    shares = np.array([share_of(each, each.nominal(study.design)) for each in study.variables])
    before = values(np.clip(shares, 0.0, 1.0)[None])[0]
    if isinstance(before, str):
        require([Finding("design", before, "Correct the design file first")])
    assert isinstance(before, Point)  # noqa: S101  refused above
    return Setting(study, definition, kept, values, before)


def _measure_findings(study: Study, objectives: tuple[Objective, ...], kept: tuple[Requirement, ...]) -> Iterator[Finding]:
    """Measures that this stage does not have."""
    bench = bench_of(require_valid(study.design))
    measures: list[tuple[str, Measure]] = [(f"responses.{each.name}", each.measure) for each in objectives]
    measures += [(f"limits.{each.key}", each) for each in kept]
    for where, each in measures:
        value = value_or_reason(bench, each)
        if isinstance(value, str):
            yield Finding(where, value, "Use measures of this stage")


def _stated_values(study: Study, variable: Variable) -> list[float]:
    """Value of the design at each address, or of the case for each parameter."""
    variant = variable.variant
    return [float(get(study.design, address) if variant is None else variant.value(address)) for address in variable.addresses]


def share_of(variable: Variable, value: float) -> float:
    """Return the position of a value in a variable's range, from 0 to 1: the inverse of `Variable.at`.

    >>> from flexstage.base.units.quantity import LENGTH
    >>> share_of(Variable("t", (), LENGTH, 1.0, 4.0, logarithmic=True), 2.0)
    0.5
    """
    if variable.logarithmic:
        return float(np.log(value / variable.low) / np.log(variable.high / variable.low))
    return (value - variable.low) / (variable.high - variable.low)


def _range_findings(study: Study) -> Iterator[Finding]:
    """Variables whose value in the nominal design is outside their range, or differs between their addresses."""
    for each in study.variables:
        where, value = f"variables.{each.name}", each.nominal(study.design)
        unit = "" if each.relative else f" {each.quantity.si}"
        slack = _EDGE * (each.high - each.low)
        if not each.low - slack <= value <= each.high + slack:
            what = f"the nominal value is outside the range (got {value:.6g}{unit}, expected {each.low:.6g} to {each.high:.6g}{unit})"
            yield Finding(where, what, "Widen the range, or change the design")
        if not each.relative:
            found = _stated_values(study, each)
            if max(found) - min(found) > _EDGE * max(map(abs, found)):
                what = f"the design's numbers at the variable's addresses differ (got {min(found):.6g} to {max(found):.6g}{unit})"
                yield Finding(where, what, "Use a range in percent, or two variables")
