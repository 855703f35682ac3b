"""Models of stages that stand: elastic results are given only where the drawn position is an equilibrium that holds."""

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
"""Strokes of more actuators have too many corners."""


def standing(mechanism: Mechanism) -> LinearModel:
    """The lumped model of a stage whose dead load lets the drawn position stand; of a batch, or with superelements, nothing is looked at.

    Raises `DesignError` where the load factor of weight, payloads and forces is below 1.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> len(standing(parallelogram()).coordinates)
    18
    """
    model, found = _under_load(mechanism)
    if found is not None:
        require(found.refusals)
    return model


def under_load(mechanism: Mechanism) -> Stability | None:
    """Load factors of the dead load, strokes at rest; `None` of a batch and of a stage with superelements."""
    return _under_load(mechanism)[1]


@SESSION.keep(2)
def drawn(mechanism: Mechanism) -> LinearModel:
    """The lumped model, whether the drawn position stands or not, kept for what else one command asks of the same description.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> len(drawn(parallelogram()).coordinates)
    18
    """
    return lumped(mechanism)


@SESSION.keep(2)
def kinematics(mechanism: Mechanism) -> Kinematics:
    """The ideal kinematics, kept in the same way.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> kinematics(parallelogram()).mobility
    1
    """
    return ideal(mechanism)


@SESSION.keep(2)
def _under_load(mechanism: Mechanism) -> tuple[LinearModel, Stability | None]:
    """The lumped model and how it stands, kept for what else one command asks of the same description."""
    model = drawn(mechanism)
    known = not model.designs and not expand(mechanism).superelements
    return model, stability(mechanism, model) if known else None


def require_standing(mechanism: Mechanism) -> None:
    """Refuse elastic results of a stage whose drawn position does not hold; where the lumped model has no answer, nothing is said.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> require_standing(parallelogram())
    """
    try:
        found = _under_load(mechanism)[1]
    except DesignError:
        return
    if found is not None:
        require(found.refusals)


@SESSION.keep(2)
def load_factors(mechanism: Mechanism) -> Stability | None:
    """Load factors of the whole stage over all strokes from no voltage; `None` where it has no elastic model.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> bool(load_factors(parallelogram()).worst > 100.0)
    True
    """
    limits = stroke_limits(mechanism).from_zero
    try:
        return stability(mechanism, drawn(mechanism), limits if 0 < len(limits.actuators) <= _CORNERS else None)
    except DesignError:
        return None
