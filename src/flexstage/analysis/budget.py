"""The error budget of a stage, composed from its results."""

from __future__ import annotations

from collections.abc import Mapping

from flexstage.analysis.drift import Drift, drift
from flexstage.analysis.error_budget import ErrorBudget, Evidence, command_strokes, error_budget
from flexstage.analysis.lost_motion import lost_motion
from flexstage.analysis.standing import standing
from flexstage.analysis.workspace.gauging import pose_resolution
from flexstage.analysis.workspace.map_error import map_error_at
from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.number import Number
from flexstage.mechanism.expand import expand
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.finite import design_shape
from flexstage.models.ideal import ideal


def budget(
    mechanism: Mechanism,
    command: Mapping[str, Number],
    *,
    at: str = PLATFORM,
    temperature: Number = 0.0,
    drifted: Drift | None = None,
    coverage: float = 3.0,
) -> ErrorBudget:
    """Error budget at a point of the platform over a box of commands (half widths by coordinate [m, rad]) and a temperature change [K].

    Lost motion and drift (strokes held) by the lumped model. `drifted` absent: the ground as the description has it (`ground_of`).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = budget(double_triangle(), {"x": 50e-6}, temperature=0.1)
    >>> found.ideal.columns
    ('lost motion', 'crosstalk', 'linear map', 'gauge noise', 'quantisation', 'drift')
    """
    assembly = expand(mechanism)
    if at != PLATFORM and at not in assembly.points:
        raise refuse(at, "no point of this name is in the description", suggest_nearest(at, (PLATFORM, *assembly.points)))
    body, point = (PLATFORM, assembly.bodies[PLATFORM].reference) if at == PLATFORM else assembly.points[at]
    if body != PLATFORM:
        raise refuse(at, f"is a point of {body}", "An error budget is that of a point of the platform")
    kinematics, model = ideal(mechanism), standing(mechanism)
    warmed = drift(mechanism, model) if drifted is None else drifted
    corners = command_strokes(kinematics, command, depth=len(design_shape(mechanism, kinematics)))
    evidence = Evidence(
        kinematics=kinematics,
        lost_motion=lost_motion(kinematics, model),
        map_error=map_error_at(mechanism, kinematics, corners),
        resolution=pose_resolution(mechanism, kinematics),
        drift=warmed.of(at),
        arm=point - assembly.bodies[PLATFORM].reference,
        ground=warmed.ground,
    )
    return error_budget(evidence, command, temperature=temperature, coverage=coverage)
