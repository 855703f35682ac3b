"""What an optimisation found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.analysis.requirements import Requirement
from flexstage.base.number import Array
from flexstage.studies.optimisation.values import Point
from flexstage.studies.optimisation.wanted import Wanted
from flexstage.studies.sweeps.definition import Study


@dataclass(frozen=True, eq=False)
class Binding:
    """What keeps the objective from being better: a limit, or an end of a variable's range.

    `price`: how much the objective changes [its SI unit] when the limit or end moves up by one unit [its SI unit], the rest re-optimised.
    """

    name: str
    limit: float
    unit: str
    price: float
    of_range: bool


@dataclass(frozen=True, eq=False)
class Start:
    """One start: where it began and ended (shares of the ranges), the objective there [SI], the largest violation, and its history.

    `history` are the objective and the largest violation (k, 2) design by design as the search accepted them. `agrees`: the end is
    feasible and as good as the best one within a ten-thousandth.
    """

    begun: Array
    ended: Array
    value: float
    violation: float
    evaluated: int
    converged: bool
    history: Array
    agrees: bool
    reason: str = ""


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


@dataclass(frozen=True, eq=False)
class Contradiction:
    """Limits that cannot all be kept within the ranges, though any of them left out the others can; `violation` is the least largest one.

    `point` is the design there: relative violations of the limits named are equal or less.
    """

    limits: tuple[Requirement, ...]
    violation: float
    point: Point


@dataclass(frozen=True, eq=False)
class Optimum:
    """The outcome of an optimisation with one objective.

    `before` is the design as it stands, `point` the best one found, `None` where no start found a design that keeps the limits: then
    `contradictions` say why. `idle` names variables that move none of the measures asked for. `interrupted`: the best so far.
    """

    study: Study
    wanted: Wanted
    limits: tuple[Requirement, ...]
    before: Point
    point: Point | None
    starts: tuple[Start, ...]
    binding: tuple[Binding, ...]
    rounded: Rounded | None
    contradictions: tuple[Contradiction, ...]
    idle: tuple[str, ...]
    evaluated: int
    seconds: float
    interrupted: bool = False

    @property
    def final(self) -> Point | None:
        """The design to be made: rounded where steps are given and a neighbour on them keeps the limits, else the optimum."""
        return self.point if self.rounded is None or self.rounded.point is None else self.rounded.point

    @property
    def unfinished(self) -> str:
        """Why there is no design to be made; empty where there is one."""
        if self.point is None:
            reasons = [start.reason for start in self.starts if start.reason]
            return f"no start found a design that keeps all limits{': ' + reasons[0] if reasons else ''}"
        return ""

    @property
    def agreeing(self) -> int:
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


@dataclass(frozen=True, eq=False)
class Front:
    """Designs none of which is better in both objectives: `points` from the best in the first to the best in the second."""

    study: Study
    wanted: Wanted
    limits: tuple[Requirement, ...]
    before: Point
    points: tuple[Point, ...]
    contradictions: tuple[Contradiction, ...]
    idle: tuple[str, ...]
    evaluated: int
    seconds: float
    interrupted: bool = False

    @property
    def unfinished(self) -> str:
        """Why there is no front; empty where there is one."""
        return "" if self.points else "no start found a design that keeps all limits"

    @property
    def values(self) -> Array:
        """Both objectives [SI] of all points (k, 2)."""
        return np.array([point.values[:2] for point in self.points]).reshape(-1, 2)
