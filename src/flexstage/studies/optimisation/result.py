"""Results of an optimisation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.assessment.requirements import Requirement, Verdict
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Called, Heading, Layout, Mark, UnitIn
from flexstage.base.units.quantity import RATIO
from flexstage.studies.optimisation.problem import Objective, OptimisationProblem
from flexstage.studies.optimisation.values import Point, values_of
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.variable import Variable


@dataclass(frozen=True, eq=False)
class Binding:
    """A binding limit, or a binding end of a variable's range.

    `price` is the change of the objective per unit of the limit or of the end of the range, in SI units. All variables are re-optimised for
    this change.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Binding limits",
        "name limit gain price",
        notes=(
            "Gain: improvement of the objective if the limit, or the end of a range, is relaxed by 1 % of its value.",
            "Price: change of the objective per unit of the limit, or of the end of a range.",
        ),
    )

    name: Annotated[str, Heading("limit")]
    limit: Annotated[float, UnitIn("unit"), Heading("value", digits=6)]
    unit: str
    price: Annotated[float, UnitIn("price_unit"), Heading(digits=4)]
    of_range: Annotated[bool, Called("range")]
    objective_unit: Annotated[str, INNER]

    @property
    def price_unit(self) -> str:
        """SI unit of `price`."""
        return self.objective_unit if self.unit == "1" else f"{self.objective_unit}/{self.unit}"

    @property
    def gain(self) -> Annotated[float, INNER, UnitIn("objective_unit"), Heading("gain for 1 %", digits=3)]:
        """Improvement of the objective if the limit is relaxed by 1 % of its value."""
        return abs(self.price * self.limit) * 0.01


@dataclass(frozen=True)
class Accepted:
    """A design accepted by a search: the objective [SI] and the largest relative violation of a limit."""

    objective: float
    violation: float


@dataclass(frozen=True, eq=False)
class Start:
    """A search from one start. Its first and last design are given by fractions of the variables' ranges, 0 to 1.

    `value` is the objective [SI] of the last design, `violation` is its largest relative violation of a limit. `history` (k, 2) contains
    the objective and the largest violation of each accepted design. `agrees` is true if the last design is feasible, and if its objective
    differs from the best objective by at most 0.01 % of the best or nominal objective, whichever is larger.
    """

    TABLE: ClassVar[Layout] = Layout("Starts", "value violation evaluated end agrees", head="start")

    begun: Annotated[Array, VIEW]
    ended: Annotated[Array, VIEW]
    value: Annotated[float, Called("objective"), UnitIn("unit"), Heading(digits=6)]
    violation: Annotated[float, RATIO, Heading(digits=2, unit="%")]
    evaluated: Annotated[int, Heading("designs")]
    converged: bool
    history: Array
    agrees: Annotated[bool, Heading(mark={True: Mark.PASS, False: Mark.WARN}.__getitem__)]
    unit: Annotated[str, INNER]
    reason: str = ""

    @property
    def end(self) -> str:
        """Reason why the search ended."""
        return self.reason or ("converged" if self.converged else "no further step found")

    @property
    def accepted(self) -> Annotated[tuple[Accepted, ...], VIEW, Called("history")]:
        """Accepted designs of the search."""
        return tuple(Accepted(*each) for each in self.history.tolist())


@dataclass(frozen=True, eq=False)
class Rounded:
    """The best design with values (d,) at multiples of the variables' steps, and the `loss` of the objective [SI] by rounding (0 or more).

    `tried` is the number of evaluated designs with rounded values near the optimum. If none of them is feasible, `point` is `None`, and
    `reason` explains why.
    """

    point: Point | None
    values: Array | None
    loss: float
    tried: int
    reason: str = ""


@dataclass(frozen=True)
class LimitAt:
    """A limit on a measure, the value [SI] of this measure for a design, and the relative margin."""

    measure: str
    point: str
    demand: str
    value: float
    margin: float
    passed: bool


@dataclass(frozen=True)
class DesignPoint:
    """A design: variables and objectives by name in SI units, and its limits. A relative variable is a factor on the nominal value."""

    variables: Mapping[str, float]
    objectives: Mapping[str, float]
    limits: tuple[LimitAt, ...]


@dataclass(frozen=True)
class RoundedPoint(DesignPoint):
    """The best design with rounded variables.

    `loss` is the objective's loss [SI] by rounding. `tried` is the number of evaluated designs with rounded variables near the optimum.
    """

    loss: float
    tried: int


@dataclass(frozen=True, eq=False)
class Contradiction:
    """Minimal set of limits that contradict each other within the ranges.

    `violation` is the minimum, over all designs, of the largest relative violation of these limits. `point` is the design at this minimum;
    it violates each limit in `limits` by at most `violation`. `overall` is the same minimum for all limits together, except the limits of
    earlier contradictions.
    """

    limits: tuple[Requirement, ...]
    violation: float
    point: Point
    overall: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome(InNotebook):
    """Results that all optimisations have in common. `before` is the nominal design. `contradictions` explain why no design is feasible.

    `idle` names variables without effect on any requested measure at the nominal design. `evaluated` is the number of evaluated designs.
    `interrupted`: the search was interrupted, and the results are the best so far.
    """

    study: Annotated[Study, INNER]
    definition: Annotated[OptimisationProblem, INNER]
    limits: Annotated[tuple[Requirement, ...], INNER]
    before: Annotated[Point, INNER]
    contradictions: Annotated[tuple[Contradiction, ...], INNER]
    idle: tuple[str, ...]
    evaluated: int
    seconds: Annotated[float, INNER]
    interrupted: bool = False

    @property
    def name(self) -> Annotated[str, VIEW, Called("study")]:
        """The study's name."""
        return self.study.name

    @property
    def objectives(self) -> Annotated[tuple[Objective, ...], VIEW]:
        """The objectives."""
        return self.definition.objectives

    @property
    def variables(self) -> Annotated[tuple[Variable, ...], VIEW]:
        """The variables."""
        return self.study.variables

    @property
    def seed(self) -> Annotated[int, VIEW]:
        """Seed of the random initial designs."""
        return self.definition.seed

    @property
    def initial(self) -> Annotated[DesignPoint, VIEW, Called("before")]:
        """The nominal design."""
        return self.design(self.before)

    def design(self, point: Point) -> DesignPoint:
        """Return the design at `point`, with its variables and objectives by name, in SI units."""
        first = len(self.definition.objectives)
        return DesignPoint(
            dict(zip((each.name for each in self.study.variables), values_of(self.study, point.shares).tolist(), strict=True)),
            {each.name: float(point.values[number]) for number, each in enumerate(self.definition.objectives)},
            tuple(_limit_at(each, float(value)) for each, value in zip(self.limits, point.values[first:], strict=True)),
        )


def _limit_at(limit: Requirement, value: float) -> LimitAt:
    verdict = Verdict(limit, np.asarray(value))
    return LimitAt(limit.key, limit.point, limit.text, value, float(verdict.margin), bool(verdict.passed))


@dataclass(frozen=True, eq=False, kw_only=True)
class Optimum(Outcome):
    """The outcome of an optimisation with one objective.

    `point` is the best design, or `None` if no start found a feasible design. `binding` contains the binding limits and the binding ends of
    the variables' ranges.
    """

    point: Annotated[Point | None, INNER]
    starts: tuple[Start, ...]
    binding: tuple[Binding, ...]
    rounded: Annotated[Rounded | None, INNER]

    @property
    def best(self) -> Annotated[DesignPoint | None, VIEW, Called("optimum")]:
        """The best design."""
        return None if self.point is None else self.design(self.point)

    @property
    def on_steps(self) -> Annotated[RoundedPoint | None, VIEW, Called("rounded")]:
        """The best design whose variables are multiples of their steps. Null if no variable has a step, or no such design is feasible."""
        if self.rounded is None or self.rounded.point is None:
            return None
        found = self.design(self.rounded.point)
        return RoundedPoint(found.variables, found.objectives, found.limits, self.rounded.loss, self.rounded.tried)

    @property
    def final(self) -> Point | None:
        """The final design: the feasible design with rounded variables, if it exists; otherwise the optimum."""
        return self.point if self.rounded is None or self.rounded.point is None else self.rounded.point

    @property
    def failure(self) -> str:
        """Reason why there is no final design; empty if there is one."""
        if self.point is None:
            reasons = [start.reason for start in self.starts if start.reason]
            return f"no start found a feasible design{': ' + reasons[0] if reasons else ''}"
        return ""

    @property
    def agreeing(self) -> Annotated[int, VIEW]:
        """Number of starts that found the best objective (`agrees` of `Start`)."""
        return sum(start.agrees for start in self.starts)

    def value(self, point: Point) -> float:
        """Return the objective [SI] of a design."""
        return float(point.values[0])

    @property
    def improvement(self) -> float:
        """Relative change of the objective from the nominal to the final design; NaN without a final design."""
        before = self.value(self.before)
        return np.nan if self.final is None or before == 0.0 else self.value(self.final) / before - 1.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Front(Outcome):
    """Pareto-optimal designs: `points` from the best in the first objective to the best in the second."""

    points: Annotated[tuple[Point, ...], INNER]

    @property
    def front(self) -> Annotated[tuple[DesignPoint, ...], VIEW]:
        """The designs, from the best in the first objective to the best in the second."""
        return tuple(self.design(point) for point in self.points)

    @property
    def failure(self) -> str:
        """Reason why there is no front; empty if there is one."""
        return "" if self.points else "no start found a feasible design"

    @property
    def values(self) -> Array:
        """Values [SI] of both objectives for all points (k, 2)."""
        return np.array([point.values[:2] for point in self.points]).reshape(-1, 2)
