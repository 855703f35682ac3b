"""Results of a sweep: distributions of responses, effects of variables, and failed designs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.assessment.requirements import Verdict
from flexstage.base.labelled import NOISE
from flexstage.base.notebook import InNotebook
from flexstage.base.record import INNER, VIEW, Called, Heading, Layout, UnitIn
from flexstage.base.units.quantity import RATIO
from flexstage.studies.sweeps.definition import RequestedMeasure, Study
from flexstage.studies.sweeps.effects import Effects
from flexstage.studies.sweeps.execution.store import Failure, Results
from flexstage.studies.sweeps.plan import Sampling
from flexstage.studies.sweeps.variable import Variable


@dataclass(frozen=True)
class DesignCount:
    """Numbers of planned, computed and failed designs."""

    planned: int
    computed: int
    failed: int


@dataclass(frozen=True)
class PairShare:
    """The fraction of a response's variance that two variables explain only together."""

    variables: tuple[str, str]
    share: float


@dataclass(frozen=True)
class ResponseEffects(RequestedMeasure):
    """A response, with its statistics over the designs that have values [SI], and the effects of variables on it.

    `first_order` and `total_order` contain the fraction of the response's variance due to each variable. Total fractions, and the largest
    standard errors of indices, exist only for Saltelli's plan. The standard error of second-order indices requires `pairs`.
    """

    TABLE: ClassVar[Layout] = Layout("Responses", "name address min_value mean spread max_value within_limits")

    min_value: Annotated[float, UnitIn("unit"), Heading("minimum")]
    mean: Annotated[float, UnitIn("unit")]
    deviation: float
    max_value: Annotated[float, UnitIn("unit"), Heading("maximum")]
    within_limits: Annotated[float | None, INNER, RATIO, Heading("limit met by", unit="%")]
    first_order: Mapping[str, float]
    total_order: Mapping[str, float] | None
    standard_error: float
    pairs_standard_error: float
    pairs: tuple[PairShare, ...]

    @property
    def address(self) -> Annotated[str, INNER, Heading("measure")]:
        """The measure together with the point at which it is evaluated."""
        return f"{self.key} at {self.point}" if self.measure.kind.pointed else self.key

    @property
    def spread(self) -> Annotated[float, INNER, UnitIn("unit"), Heading("deviation")]:
        """The standard deviation; zero if it is a rounding error."""
        return 0.0 if self.deviation < NOISE * abs(self.mean) else self.deviation


@dataclass(frozen=True, eq=False)
class StudyResult(InNotebook):
    """Result of a study of many designs: the `study`, and the `results` of all designs so far."""

    study: Annotated[Study, INNER]
    results: Annotated[Results, INNER]

    @property
    def name(self) -> Annotated[str, VIEW, Called("study")]:
        """The study's name."""
        return self.study.name

    @property
    def sampling(self) -> Annotated[Sampling, VIEW]:
        """Method that distributes designs over the variables' ranges."""
        return self.study.plan.sampling

    @property
    def seed(self) -> Annotated[int, VIEW]:
        """The seed of all random numbers."""
        return self.study.plan.seed

    @property
    def failures(self) -> Annotated[tuple[Failure, ...], VIEW]:
        """Failed designs, which have no values."""
        return self.results.failed


@dataclass(frozen=True, eq=False)
class Sweep(StudyResult):
    """A sweep, with the effects of variables on responses. The designs are in the results file."""

    effects: Annotated[Effects, INNER]

    @property
    def designs(self) -> Annotated[DesignCount, VIEW]:
        """Numbers of designs."""
        return DesignCount(self.results.planned, len(self.results.designs), len(self.results.failures))

    @property
    def variables(self) -> Annotated[tuple[Variable, ...], VIEW]:
        """The variables."""
        return self.study.variables

    @property
    def responses(self) -> Annotated[tuple[ResponseEffects, ...], VIEW]:
        """The responses, and the further measures to which limits apply."""
        return tuple(self._response(index, name) for index, name in enumerate(self.effects.responses))

    @property
    def method(self) -> Annotated[str, VIEW]:
        """Estimator of the variance fractions."""
        return self.effects.method

    @property
    def made(self) -> Annotated[tuple[str, ...], VIEW]:
        """Combinations of versions, processor and kernel that computed the results."""
        return self.results.made

    def _share_within_limits(self, name: str) -> float | None:
        """Share of all designs that keep the limits on a measure, with failed designs counted as violations."""
        measure, values = self.study.columns[name], self.results.column(name)
        limits = [each for each in self.study.limits if (each.key, each.point) == (measure.key, measure.point)]
        if not limits or not len(values):
            return None
        return float(np.mean(np.all([Verdict(each, values).passed for each in limits], axis=0)))

    def _response(self, index: int, name: str) -> ResponseEffects:
        found = self.effects
        total = None if found.total is None else dict(zip(found.variables, found.total[:, index].tolist(), strict=True))
        return ResponseEffects(
            name=name,
            measure=self.study.columns[name],
            min_value=float(found.low[index]),
            mean=float(found.mean[index]),
            deviation=float(found.deviation[index]),
            max_value=float(found.high[index]),
            within_limits=self._share_within_limits(name),
            first_order=dict(zip(found.variables, found.first[:, index].tolist(), strict=True)),
            total_order=total,
            standard_error=float(found.errors[0, index]),
            pairs_standard_error=float(found.errors[1, index]),
            pairs=tuple(
                PairShare((found.variables[first], found.variables[second]), float(found.pairs[first, second, index]))
                for first, second in combinations(range(len(found.variables)), 2)
            ),
        )
