"""Optimisation problem: objectives, number of starts, and the requirements that are limits."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from flexstage.analysis.assessment.requirements import Requirement, Sense, requirements
from flexstage.studies.sweeps.definition import RequestedMeasure, Study


class ObjectiveDirection(Enum):
    """Direction of an objective: maximise or minimise."""

    MAXIMISE = "maximise"
    MINIMISE = "minimise"

    @property
    def sense(self) -> Sense:
        """Sense of a limit on the objective: `at least` if the objective is maximised, `at most` if it is minimised."""
        return Sense.AT_LEAST if self is ObjectiveDirection.MAXIMISE else Sense.AT_MOST


@dataclass(frozen=True)
class Objective(RequestedMeasure):
    """Objective: a named response, its measure, and whether to maximise or minimise it."""

    direction: ObjectiveDirection


@dataclass(frozen=True)
class OptimisationProblem:
    """Optimisation problem, as the `[optimise]` section of a study's file defines it.

    A problem has one objective, or two objectives for a Pareto front of `points` designs. `starts` is the number of initial designs: the
    nominal design, then a Sobol sequence with this `seed`. If `requirements` is true, the `[requirements]` of the design are also limits.
    """

    objectives: tuple[Objective, ...]
    starts: int = 3
    seed: int = 0
    points: int = 9
    requirements: bool = True


def limits(study: Study, definition: OptimisationProblem) -> tuple[Requirement, ...]:
    """List the study's limits, and each design requirement unless a study limit has the same measure, point and sense.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> [each.key for each in limits(*leaf_study())]
    ['stroke.x', 'frequency.platform.1', 'safety']
    """
    own = requirements(study.design) if definition.requirements else ()
    limited = {(each.key, each.point, each.sense) for each in study.limits}
    return (*study.limits, *(each for each in own if (each.key, each.point, each.sense) not in limited))
