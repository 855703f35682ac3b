"""The error budget of a stage, composed from its results."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexstage.analysis.assessment.error_budget import ErrorBudget, Evidence, command_strokes, error_budget
from flexstage.analysis.linear_statics.drift import Drift, drift
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.analysis.loaded.load_effect import felt_links
from flexstage.analysis.workspace.gauging import pose_resolution
from flexstage.analysis.workspace.map_error import map_error_at
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, refuse, suggest_nearest
from flexstage.base.number import Array, Number, stack
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.finite import design_shape
from flexstage.models.ideal import ideal
from flexstage.models.linear.model import LinearModel


@check_arguments
def budget(
    mechanism: Mechanism,
    command: Mapping[str, Number],
    *,
    at: str = PLATFORM,
    temperature: Number | None = 0.0,
    drifted: Drift | None = None,
    coverage: float = 3.0,
) -> ErrorBudget:
    """Error budget at a point of the platform over a box of commands (half widths by coordinate [m, rad]) and a temperature change [K].

    Lost motion and drift (strokes held) by the lumped model, of the loaded stage where its dead load is felt. `drifted` absent: the ground
    as the description has it (`ground_of`). No change of temperature (0, or `None`: 1 K where drift is known) asks for no drift: what
    states no expansion then leaves it out, and `reasons` say so.

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
    kinematics, model = ideal(mechanism), felt_links(mechanism)
    warmed, reasons = (drifted, {}) if drifted is not None else _drift(mechanism, model, asked=bool(np.any(temperature)))
    corners = command_strokes(kinematics, command, depth=len(design_shape(mechanism, kinematics)))
    evidence = Evidence(
        kinematics=kinematics,
        lost_motion=lost_motion(kinematics, model),
        map_error=map_error_at(mechanism, kinematics, corners),
        resolution=pose_resolution(mechanism, kinematics),
        drift=None if warmed is None else warmed.of(at),
        arm=point - assembly.bodies[PLATFORM].reference,
        ground=None if warmed is None else warmed.ground,
        reasons=reasons,
        steps=_steps(assembly, kinematics.actuators),
    )
    usual = 0.0 if warmed is None else 1.0
    return error_budget(evidence, command, temperature=usual if temperature is None else temperature, coverage=coverage)


def _steps(assembly: Assembly, actuators: tuple[str, ...]) -> Array | None:
    """Steps of the actuators (..., n) [m], NaN where they are not stated; `None` where all move continuously."""
    steps = [assembly.actuator(name).step for name in actuators]
    continuous = all(step is not None and not np.any(step) for step in steps)
    return None if continuous else stack([np.nan if step is None else step for step in steps])


def _drift(mechanism: Mechanism, model: LinearModel, *, asked: bool) -> tuple[Drift | None, dict[str, str]]:
    """Drift, or why it is not known where no temperature asks for it."""
    try:
        return drift(mechanism, model), {}
    except DesignError as error:
        if asked:
            raise
        return None, {"drift": "; ".join(f"{finding.where} {finding.what}" for finding in error.findings)}
