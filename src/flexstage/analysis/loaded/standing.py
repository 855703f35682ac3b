"""Check that a stage is stable in its nominal position, which all elastic results require."""

from __future__ import annotations

from flexstage.analysis.loaded.stability import Stability, stability
from flexstage.analysis.workspace.stroke import stroke_limits
from flexstage.base.finding import DesignError, require
from flexstage.base.session import SESSION
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.lumped import lumped

_CORNERS = 12
"""Largest number of actuators whose stroke corners are enumerated."""


def standing(mechanism: Mechanism) -> LinearModel:
    """Return the lumped model after a check that the nominal position is stable. Batches and stages with superelements are not checked.

    Raises `DesignError` if the load factor of weight, payloads and forces is below 1.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> len(standing(parallelogram()).coordinates)
    18
    """
    result = under_load(mechanism)
    require(() if result is None else result.refusals)
    return drawn(mechanism)


@SESSION.keep(2)
def under_load(mechanism: Mechanism) -> Stability | None:
    """Return the load factors of the permanent load with zero strokes; `None` for a batch or a stage with superelements."""
    model = drawn(mechanism)
    return None if model.designs or expand(mechanism).superelements else stability(mechanism, model)


@SESSION.keep(2)
def drawn(mechanism: Mechanism) -> LinearModel:
    """Return the lumped model without a stability check. Cached by description.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> len(drawn(parallelogram()).coordinates)
    18
    """
    return lumped(mechanism)


@SESSION.keep(2)
def kinematics(mechanism: Mechanism) -> Kinematics:
    """Return the ideal kinematics. Cached by description.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> kinematics(parallelogram()).mobility
    1
    """
    return ideal(mechanism)


def require_standing(mechanism: Mechanism) -> None:
    """Raise `DesignError` if a stage is unstable in its nominal position. A stage without a lumped model is not checked.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> require_standing(parallelogram())
    """
    try:
        result = under_load(mechanism)
    except DesignError:
        return
    require(() if result is None else result.refusals)


@SESSION.keep(2)
def load_factors(mechanism: Mechanism) -> Stability | None:
    """Return the load factors of the stage, also for the worst strokes from zero voltage; `None` without an elastic model.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> bool(load_factors(parallelogram()).worst > 100.0)
    True
    """
    limits = stroke_limits(mechanism).from_zero
    try:
        return stability(mechanism, drawn(mechanism), limits if 0 < len(limits.actuators) <= _CORNERS else None)
    except DesignError:
        return None
