"""The complete analysis of a stage: every analysis of one reading, as one value for reports and applications."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from flexstage.analysis.lost_motion import LostMotion, lost_motion
from flexstage.analysis.modes import Modes, modes
from flexstage.analysis.response import response, transmissibility
from flexstage.analysis.statics import Statics, statics
from flexstage.base.number import Table
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.readings.ideal import ideal
from flexstage.readings.linear.frequency import Response
from flexstage.readings.linear.kinematics import Kinematics
from flexstage.readings.linear.model import LinearModel
from flexstage.readings.lumped import lumped
from flexstage.readings.mapped import mapped
from flexstage.studies.attempt import Attempts
from flexstage.studies.reading import Reading
from flexstage.studies.workspace import Workspace, workspace

__all__ = ["Analysis", "Reading", "analyse", "platform_modes", "read"]

_MODE_LIMIT = 1000.0
_RIGID = "the ideal reading has no elasticity"


@dataclass(frozen=True, eq=False)
class Analysis:
    """All results of one reading of a stage; `None` where a reading or a stage does not give them, and `missing` says why, by field name.

    `response` is that of the platform's twist and all gauges to the strokes, `transmissibility` that of the platform to the ground.
    """

    mechanism: Mechanism
    reading: Reading
    kinematics: Kinematics
    model: LinearModel | None
    statics: Statics | None
    lost_motion: LostMotion | None
    modes: Modes | None
    response: Response | None
    transmissibility: Response | None
    workspace: Workspace | None
    missing: Mapping[str, str]


def read(mechanism: Mechanism, reading: Reading) -> LinearModel | None:
    """The linear model of an elastic reading; `None` for the ideal one.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(read(double_triangle(), Reading.MAPPED).coordinates)
    6
    """
    if reading is Reading.IDEAL:
        return None
    return mapped(mechanism) if reading is Reading.MAPPED else lumped(mechanism)


def analyse(mechanism: Mechanism, reading: Reading = Reading.LUMPED) -> Analysis:
    """Every analysis of one reading.

    What a stage cannot give (an under-actuated one has no lost motion) is `None`, its reason in `missing`. Raises `DesignError` where
    the reading itself is refused.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(float(analyse(double_triangle(), Reading.MAPPED).modes.frequencies[0]), 2)
    110.91
    """
    kinematics = ideal(mechanism)
    model = read(mechanism, reading)
    attempt = Attempts()
    lost = attempt.given("lost_motion", model, _RIGID, lambda known: lost_motion(kinematics, known))
    seen = (PLATFORM, *kinematics.gauges)
    return Analysis(
        mechanism=mechanism,
        reading=reading,
        kinematics=kinematics,
        model=model,
        statics=attempt.given("statics", model, _RIGID, statics),
        lost_motion=lost,
        modes=attempt.given("modes", model, _RIGID, lambda known: platform_modes(mechanism, known)),
        response=attempt.given("response", model, _RIGID, lambda known: response(known, seen, kinematics.actuators)),
        transmissibility=attempt.given("transmissibility", model, _RIGID, transmissibility),
        workspace=attempt.of("workspace", lambda: workspace(mechanism, kinematics, model, lost=lost)),
        missing=Table(attempt.missing),
    )


def platform_modes(mechanism: Mechanism, model: LinearModel) -> Modes:
    """Modes with the description's frequency limit for the platform's modes, or 1 kHz.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> platform_modes(double_triangle(), mapped(double_triangle())).limit
    1000.0
    """
    limit = mechanism.mode_limit if isinstance(mechanism.mode_limit, float) else _MODE_LIMIT
    return modes(model, limit=limit, count=min(6, len(model.coordinates)))
