"""Stages of a solid model, told by the process that computes and gathered over all components by the one that waits."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum


class Stage(Enum):
    """What is being done to a component, in this order."""

    STARTING = "starting"
    DRAWING = "drawing"
    MESHING = "meshing"
    ASSEMBLING = "assembling"
    FACTORISING = "factorising"
    REDUCING = "reducing modes"
    PROJECTING = "projecting"


_SHARES = {
    Stage.STARTING: 0.03,
    Stage.DRAWING: 0.02,
    Stage.MESHING: 0.15,
    Stage.ASSEMBLING: 0.10,
    Stage.FACTORISING: 0.10,
    Stage.REDUCING: 0.25,
    Stage.PROJECTING: 0.35,
}
"""Usual shares of a component's time, at orders two and three."""

Report = Callable[[Stage, float], None]
"""Told of a stage and the fraction of it that is done."""


def silent(_stage: Stage, _fraction: float) -> None:
    """Report to nobody.

    >>> silent(Stage.DRAWING, 0.0)
    """


def fraction_done(stage: Stage, fraction: float) -> float:
    """Fraction of a component that is done when a fraction of a stage is.

    >>> fraction_done(Stage.STARTING, 0.0), round(fraction_done(Stage.MESHING, 1.0), 2), round(fraction_done(Stage.PROJECTING, 1.0), 9)
    (0.0, 0.2, 1.0)
    """
    stages = list(Stage)
    return sum(_SHARES[each] for each in stages[: stages.index(stage)]) + _SHARES[stage] * min(max(fraction, 0.0), 1.0)
