"""What an optimisation found."""

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
    """What keeps the objective from being better: a limit, or an end of a variable's range.

    `price`: how much the objective changes [its SI unit] when the limit or end moves up by one unit [its SI unit], the rest re-optimised.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Binding limits",
        "name limit gain price",
        notes=(
            "Gain: of the objective, where the limit or end of the range is relaxed by 1 % of its value. Price: its change per unit of it.",
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
        """SI unit of the price."""
        return self.objective_unit if self.unit == "1" else f"{self.objective_unit}/{self.unit}"

    @property
    def gain(self) -> Annotated[float, INNER, UnitIn("objective_unit"), Heading("gain for 1 %", digits=3)]:
        """Gain of the objective where the limit is relaxed by 1 % of its value."""
        return abs(self.price) * (abs(self.limit) or 1.0) * 0.01


@dataclass(frozen=True)
class Accepted:
    """A design that a search accepted: the objective [SI] and the largest relative violation of a limit."""

    objective: float
    violation: float


@dataclass(frozen=True, eq=False)
class Start:
    """One start: where it began and ended (shares of the ranges), the objective there [SI], the largest violation, and its history.

    `history` are the objective and the largest violation (k, 2) design by design as the search accepted them. `agrees`: the end is
    feasible and as good as the best one within a ten-thousandth.
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
        """How it ended."""
        return self.reason or ("converged" if self.converged else "no further step found")

    @property
    def accepted(self) -> Annotated[tuple[Accepted, ...], VIEW, Called("history")]:
        """Designs as the search accepted them."""
        return tuple(Accepted(*each) for each in self.history.tolist())


@dataclass(frozen=True, eq=False)
class Rounded:
    """The best design that can be made: values (d,) on the variables' steps, objective and its `loss` in the objective's unit, >= 0.

    `tried`: how many neighbours were evaluated. `point` is `None` where none of them keeps the limits; `reason` then says so.
    """

    point: Point | None
    values: Array | None
    loss: float
    tried: int
    reason: str = ""


@dataclass(frozen=True)
class LimitAt:
    """A limit and the value [SI] that a design has, with the relative margin."""

    measure: str
    point: str
    demand: str
    value: float
    margin: float
    passed: bool


@dataclass(frozen=True)
class DesignPoint:
    """A design: variables and objectives by name [SI; factors on what the design states for relative variables], and its limits."""

    variables: Mapping[str, float]
    objectives: Mapping[str, float]
    limits: tuple[LimitAt, ...]


@dataclass(frozen=True)
class RoundedPoint(DesignPoint):
    """The best design on the variables' steps: what rounding costs the objective [SI], and how many neighbours were tried."""

    loss: float
    tried: int


@dataclass(frozen=True, eq=False)
class Contradiction:
    """Limits that cannot all be kept within the ranges, though any of them left out the others can; `violation` is the least largest one.

    `point` is the design there: relative violations of the limits named are equal or less.
    """

    limits: tuple[Requirement, ...]
    violation: float
    point: Point


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome(InNotebook):
    """What every optimisation tells: `before` is the design as it stands; `contradictions` say why no design keeps the `limits`.

    `idle` names variables that move none of the measures asked for. `evaluated`: designs in all. `interrupted`: the best so far.
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
        """What is to be best."""
        return self.definition.objectives

    @property
    def variables(self) -> Annotated[tuple[Variable, ...], VIEW]:
        """What may be moved."""
        return self.study.variables

    @property
    def seed(self) -> Annotated[int, VIEW]:
        """The seed of its starts."""
        return self.definition.seed

    @property
    def initial(self) -> Annotated[DesignPoint, VIEW, Called("before")]:
        """The design as it stands."""
        return self.design(self.before)

    def design(self, point: Point) -> DesignPoint:
        """A design with its names, in SI."""
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

    `point` is the best design found, `None` where no start found one that keeps the limits. What keeps it from being better is `binding`.
    """

    point: Annotated[Point | None, INNER]
    starts: tuple[Start, ...]
    binding: tuple[Binding, ...]
    rounded: Annotated[Rounded | None, INNER]

    @property
    def best(self) -> Annotated[DesignPoint | None, VIEW, Called("optimum")]:
        """The best design found."""
        return None if self.point is None else self.design(self.point)

    @property
    def on_steps(self) -> Annotated[RoundedPoint | None, VIEW, Called("rounded")]:
        """The best design that can be made; null without steps, or where no neighbour keeps the limits."""
        if self.rounded is None or self.rounded.point is None:
            return None
        found = self.design(self.rounded.point)
        return RoundedPoint(found.variables, found.objectives, found.limits, self.rounded.loss, self.rounded.tried)

    @property
    def final(self) -> Point | None:
        """The design to be made: rounded where steps are given and a neighbour on them keeps the limits, else the optimum."""
        return self.point if self.rounded is None or self.rounded.point is None else self.rounded.point

    @property
    def failure(self) -> str:
        """Why there is no design to be made; empty where there is one."""
        if self.point is None:
            reasons = [start.reason for start in self.starts if start.reason]
            return f"no start found a design that keeps all limits{': ' + reasons[0] if reasons else ''}"
        return ""

    @property
    def agreeing(self) -> Annotated[int, VIEW]:
        """How many starts ended as good as the best."""
        return sum(start.agrees for start in self.starts)

    def value(self, point: Point) -> float:
        """The objective [SI] at a design."""
        return float(point.values[0])

    @property
    def improvement(self) -> float:
        """Relative change of the objective from the design as it stands to the final one; NaN without one."""
        before = self.value(self.before)
        return np.nan if self.final is None or before == 0.0 else self.value(self.final) / before - 1.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Front(Outcome):
    """Designs none of which is better in both objectives: `points` from the best in the first to the best in the second."""

    points: Annotated[tuple[Point, ...], INNER]

    @property
    def front(self) -> Annotated[tuple[DesignPoint, ...], VIEW]:
        """The designs, from the best in the first objective to the best in the second."""
        return tuple(self.design(point) for point in self.points)

    @property
    def failure(self) -> str:
        """Why there is no front; empty where there is one."""
        return "" if self.points else "no start found a design that keeps all limits"

    @property
    def values(self) -> Array:
        """Both objectives [SI] of all points (k, 2)."""
        return np.array([point.values[:2] for point in self.points]).reshape(-1, 2)
