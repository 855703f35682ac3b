"""Stages of a solid model's computation: the computing process reports the stages; the waiting process sums them over all components."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum


class Stage(Enum):
    """Stages of a component's computation, in this order."""

    STARTING = "starting"
    DRAWING = "drawing"
    MESHING = "meshing"
    ASSEMBLING = "assembling"
    FACTORISING = "factorising"
    REDUCING = "reducing modes"
    PROJECTING = "projecting"


_SHARES = {
    Stage.STARTING: 0.01,
    Stage.DRAWING: 0.01,
    Stage.MESHING: 0.05,
    Stage.ASSEMBLING: 0.15,
    Stage.FACTORISING: 0.30,
    Stage.REDUCING: 0.38,
    Stage.PROJECTING: 0.10,
}
"""Usual fractions of a component's computing time for each stage, at orders two and three, if the mesh exists already."""

Report = Callable[[Stage, float], None]
"""Function called with a stage and its completed fraction."""


def silent(_stage: Stage, _fraction: float) -> None:
    """Ignore the progress.

    >>> silent(Stage.DRAWING, 0.0)
    """


def fraction_done(stage: Stage, fraction: float) -> float:
    """Compute the completed fraction of the work on a component, from the completed fraction of a stage.

    >>> fraction_done(Stage.STARTING, 0.0), round(fraction_done(Stage.MESHING, 1.0), 2), round(fraction_done(Stage.PROJECTING, 1.0), 9)
    (0.0, 0.07, 1.0)
    """
    stages = list(Stage)
    return sum(_SHARES[each] for each in stages[: stages.index(stage)]) + _SHARES[stage] * min(max(fraction, 0.0), 1.0)
