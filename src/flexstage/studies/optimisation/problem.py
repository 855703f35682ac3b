"""Optimisation problem: objectives, number of starts, and the requirements that are limits."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from flexstage.analysis.assessment.requirements import Requirement, Sense, requirements
from flexstage.studies.sweeps.definition import RequestedMeasure, Study


class ObjectiveDirection(Enum):
    """Direction of an objective."""

    MAXIMISE = "maximise"
    MINIMISE = "minimise"

    @property
    def sense(self) -> Sense:
        """Better side of a limit."""
        return Sense.AT_LEAST if self is ObjectiveDirection.MAXIMISE else Sense.AT_MOST


@dataclass(frozen=True)
class Objective(RequestedMeasure):
    """A response by name, its measure, and its direction."""

    direction: ObjectiveDirection


@dataclass(frozen=True)
class OptimisationProblem:
    """Optimisation problem, as the `[optimise]` section of a study's file defines it.

    One objective, or two for a front of `points` designs. `starts`: number of initial designs, first the nominal design, then a Sobol
    sequence with this `seed`. `requirements`: the design's own `[requirements]` are limits too.
    """

    objectives: tuple[Objective, ...]
    starts: int = 3
    seed: int = 0
    points: int = 9
    requirements: bool = True


def limits(study: Study, definition: OptimisationProblem) -> tuple[Requirement, ...]:
    """List all limits: the study's, then the design's requirements on measures that the study does not limit on that side.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> [each.key for each in limits(*leaf_study())]
    ['stroke.x', 'frequency.platform.1', 'safety']
    """
    own = requirements(study.design) if definition.requirements else ()
    limited = {(each.key, each.point, each.sense) for each in study.limits}
    return (*study.limits, *(each for each in own if (each.key, each.point, each.sense) not in limited))
