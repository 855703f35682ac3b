"""The complete analysis of a stage: every analysis of one reading, as one value for reports and applications."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from flexstage.analysis.lost_motion import LostMotion, lost_motion
from flexstage.analysis.modes import Modes, modes
from flexstage.analysis.statics import Statics, statics
from flexstage.mechanism.mechanism import Mechanism
from flexstage.readings.ideal import ideal
from flexstage.readings.linear.kinematics import Kinematics
from flexstage.readings.linear.model import LinearModel
from flexstage.readings.lumped import lumped
from flexstage.readings.mapped import mapped


class Reading(Enum):
    """The theories a stage can be read by."""

    IDEAL = "ideal"
    MAPPED = "mapped"
    LUMPED = "lumped"


@dataclass(frozen=True, eq=False)
class Analysis:
    """All results of one reading of a stage; `None` where a reading does not give them (an ideal reading has no stiffness)."""

    mechanism: Mechanism
    reading: Reading
    kinematics: Kinematics
    model: LinearModel | None
    statics: Statics | None
    lost_motion: LostMotion | None
    modes: Modes | None


def read(mechanism: Mechanism, reading: Reading) -> LinearModel | None:
    """The linear model of an elastic reading; `None` for the ideal one."""
    if reading is Reading.IDEAL:
        return None
    return mapped(mechanism) if reading is Reading.MAPPED else lumped(mechanism)


def analyse(mechanism: Mechanism, reading: Reading = Reading.LUMPED) -> Analysis:
    """Every analysis of one reading. Under-actuated stages have no lost motion (their mapping does not exist)."""
    kinematics = ideal(mechanism)
    model = read(mechanism, reading)
    if model is None:
        return Analysis(mechanism, reading, kinematics, None, None, None, None)
    return Analysis(
        mechanism,
        reading,
        kinematics,
        model,
        statics(model),
        lost_motion(kinematics, model) if kinematics.actuated else None,
        _modes(mechanism, model),
    )


def _modes(mechanism: Mechanism, model: LinearModel) -> Modes:
    limit = mechanism.mode_limit if isinstance(mechanism.mode_limit, float) else 1000.0
    return modes(model, limit=limit, count=min(6, len(model.coordinates)))
