"""Error budget of a stage, composed from its results."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexstage.analysis.assessment.error_budget import SOURCES, STEPS, ErrorBudget, command_columns, command_strokes
from flexstage.analysis.linear_statics.drift import Drift, drift
from flexstage.analysis.linear_statics.lost_motion import LostMotion, lost_motion
from flexstage.analysis.loaded.load_effect import felt_links
from flexstage.analysis.workspace.gauging import pose_resolution
from flexstage.analysis.workspace.map_error import map_error_at
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, refuse, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array, Number, stack
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.finite import design_shape
from flexstage.models.ideal import ideal
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS, transport


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
    """Compute the error budget at a platform point for a box of commands (half widths [m, rad]) and a temperature change [K].

    Lost motion and drift (strokes fixed) are by the lumped model, of the loaded stage if its permanent load is significant. Default
    `drifted`: the ground of the description (`ground_of`). A temperature change of `None` means 1 K if drift is known. With 0 or `None`,
    missing expansion coefficients omit drift, with a note in `reasons`.

    Lost motion J diag(Lambda) R_a xi, crosstalk J (Lambda - diag) R_a xi with the motion outside the ideal ones. With the gains a = (R_a
    V^+ T)^-1 R_a xi, only the residual T a - V xi remains, as crosstalk. Linear map: finite minus linear kinematics at the corners. Noise:
    `coverage` standard deviations. Quantisation: half a step of every gauge with the worst signs. Stepping actuators: half a step of each
    in the same direction, in a separate column (uniformly distributed, its standard deviation is step/sqrt(12)). Largest absolute values.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = budget(double_triangle(), {"x": 50e-6}, temperature=0.1)
    >>> found.ideal.columns
    ('lost motion', 'crosstalk', 'linear map', 'gauge noise', 'quantisation', 'drift')
    """
    assembly = expand(mechanism)
    if at != PLATFORM and at not in assembly.points:
        raise refuse(at, "unknown point", suggest_nearest(at, (PLATFORM, *assembly.points)))
    body, point = (PLATFORM, assembly.bodies[PLATFORM].reference) if at == PLATFORM else assembly.points[at]
    if body != PLATFORM:
        raise refuse(at, f"it is a point of {body}", "Use a point of the platform")
    kinematics, model = ideal(mechanism), felt_links(mechanism)
    warmed, reasons = (drifted, {}) if drifted is not None else _drift(mechanism, model, asked=bool(np.any(temperature)))
    temperature = float(warmed is not None) if temperature is None else temperature
    corners = command_strokes(kinematics, command, depth=len(design_shape(mechanism, kinematics)))
    lost, finite = lost_motion(kinematics, model), map_error_at(mechanism, kinematics, corners)
    resolution, steps = pose_resolution(mechanism, kinematics), _steps(assembly, kinematics.actuators)
    half = np.abs(stack(list(command.values()))) if command else np.zeros(0)
    carry = transport(point - assembly.bodies[PLATFORM].reference)
    errors = _command_errors(kinematics, lost, command_columns(kinematics, command))
    loss, cross, left = (_times(np.abs(carry @ each), half) for each in errors)
    seen = carry @ resolution.inverse.values
    common = [
        np.max(np.abs((carry @ finite.errors[..., None])[..., 0]), axis=0),
        coverage * np.sqrt(_times(seen**2, resolution.gauge_noise**2)),
        _times(np.abs(seen), 0.5 * resolution.gauge_steps),
        np.full(6, np.nan) if warmed is None else np.abs(warmed.of(at).values[..., :, 0]) * np.abs(temperature),
        *([] if steps is None else [_times(np.abs(carry @ lost.gain.values), 0.5 * steps)]),
    ]
    sources = (*SOURCES, STEPS)[: 2 + len(common)]
    units = tuple((unit,) * len(sources) for unit in TWIST_UNITS)
    plain, corrected = (Matrix(stack([*own, *common]), COMPONENTS, sources, units) for own in ((loss, cross), (np.zeros(6), left)))
    missing = tuple(name for index, name in enumerate(sources) if np.any(np.isnan(plain.values[..., index])))
    ground = None if warmed is None else warmed.ground
    provenance = f"{lost.provenance}; {finite.provenance}"
    return ErrorBudget(plain, corrected, dict(command), temperature, missing, provenance, ground, coverage, reasons)


def _command_errors(kinematics: Kinematics, lost: LostMotion, columns: list[int]) -> tuple[Array, Array, Array]:
    """Errors (..., 6, c) per command: own loss, crosstalk, and the residual of the correction gains."""
    strokes = kinematics.mapping.values[..., columns]
    own = np.eye(strokes.shape[-2]) * lost.loss.values
    loss = kinematics.jacobian.values @ (own @ strokes)
    total = kinematics.motion[..., columns] - lost.gain.values @ strokes
    left = kinematics.motion[..., columns] - lost.gain.values @ lost.correction.values[..., columns]
    return loss, total - loss, left


def _times(matrix: Array, vector: Array) -> Array:
    return (matrix @ vector[..., None])[..., 0]


def _steps(assembly: Assembly, actuators: tuple[str, ...]) -> Array | None:
    """Steps of the actuators (..., n) [m], NaN if unspecified; `None` if all move continuously."""
    steps = [assembly.actuator(name).step for name in actuators]
    continuous = all(step is not None and not np.any(step) for step in steps)
    return None if continuous else stack([np.nan if step is None else step for step in steps])


def _drift(mechanism: Mechanism, model: LinearModel, *, asked: bool) -> tuple[Drift | None, dict[str, str]]:
    """Drift; without a required temperature change, `None` with the reason if it is unknown."""
    try:
        return drift(mechanism, model), {}
    except DesignError as error:
        if asked:
            raise
        return None, {"drift": "; ".join(f"{finding.where}: {finding.what}" for finding in error.findings)}
