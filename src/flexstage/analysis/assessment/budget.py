"""Computation of the error budget of a stage from its other results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from flexstage.analysis.assessment.error_budget import NOISES, PARASITIC, STEPS, ErrorBudget, command_columns, command_strokes
from flexstage.analysis.attempt import Attempts
from flexstage.analysis.dynamics.random_response import Spectrum, random_response
from flexstage.analysis.dynamics.response import default_frequencies
from flexstage.analysis.linear_statics.drift import Drift, drift
from flexstage.analysis.linear_statics.lost_motion import LostMotion, lost_motion
from flexstage.analysis.loaded.load_effect import loaded_lumped_model
from flexstage.analysis.workspace.gauging import pose_resolution
from flexstage.analysis.workspace.map_error import map_error_at
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, refuse, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array, Number, matvec, stack
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.models.finite import design_shape
from flexstage.models.ideal import ideal
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import static_gain
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS, transport

_NO_DENSITY = "the amplitude spectral density of the inputs is not specified (--input-asd)"


@check_arguments
def budget(
    mechanism: Mechanism,
    command: Mapping[str, Number],
    *,
    at: str = PLATFORM,
    temperature: Number | None = 0.0,
    drifted: Drift | None = None,
    coverage: float = 3.0,
    noise: Mapping[str, Spectrum] | None = None,
    band: tuple[float, float] | None = None,
) -> ErrorBudget:
    """Compute the error budget at a platform point for a box of displacements (half widths [m, rad]) and a temperature change [K].

    Lost motion and drift (strokes fixed) are computed by the lumped model, for the loaded stage if the permanent load is significant. Drift
    is computed with the ground material of the description (`ground_of`), unless the argument `drifted` contains the drift. If the
    temperature change is `None`, drift is computed for 1 K. If expansion coefficients are missing and the change is 0 or `None`, drift is
    omitted, and `reasons` contains the reason.

    The displacements are xi, R_a contains the strokes per platform motion, and the ideal strokes are a = R_a xi. J contains the ideal
    platform motions per stroke, T the platform motions per stroke in the elastic model, and V the ideal motions. The matrix of lost motion
    is Lambda = I - R_a V^+ T. Each contribution is a largest absolute value:

    - lost motion: J diag(Lambda) R_a xi, with the diagonal part diag(Lambda);
    - crosstalk: J (Lambda - diag(Lambda)) R_a xi, plus the motion outside the ideal motions;
    - crosstalk with lost motion corrected: the residual T a - V xi, with the corrected strokes a = (R_a V^+ T)^-1 R_a xi;
    - linear map: the motion by finite kinematics minus the motion by linear kinematics, at the corners of the box;
    - gauge noise: `coverage` standard deviations;
    - quantisation: half a step of every gauge with the worst signs;
    - actuator steps: half a step of each actuator with the worst signs (the standard deviation of this error is step/sqrt(12)).

    For a force-driven stage in open loop, the forces are u = (V^+ C)^+ xi, where C is the static gain of the elastic model. The budget then
    has the parasitic motion C u - V xi instead of lost motion, crosstalk and linear map. `noise` contains one-sided power spectral
    densities of actuator inputs (current, force, stroke), wrenches and ground motion. The budget then contains the resulting rms motion
    relative to the ground: the density of this motion is integrated over `band` [Hz] (default: the band of `response`).

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
        raise refuse(at, f"this point belongs to {body}, not to the platform", "Use a point of the platform")
    kinematics, model = ideal(mechanism), loaded_lumped_model(mechanism)
    forced = bool(kinematics.thrusts) and not kinematics.actuated
    warmed, reasons = (drifted, {}) if drifted is not None else _drift(mechanism, model, asked=bool(np.any(temperature)))
    temperature = float(warmed is not None) if temperature is None else temperature
    half = np.abs(stack(list(command.values()))) if command else np.zeros(0)
    carry = transport(point - assembly.bodies[PLATFORM].reference)
    columns = command_columns(kinematics, command)
    steps: dict[str, Array] = {}
    if forced:
        plain = corrected = {PARASITIC: matvec(np.abs(carry @ _forced_errors(kinematics, model, columns)), half)}
        provenance = model.provenance
    else:
        corners = command_strokes(kinematics, command, depth=len(design_shape(mechanism, kinematics)))
        lost, finite = lost_motion(kinematics, model), map_error_at(mechanism, kinematics, corners)
        loss, cross, left = (matvec(np.abs(carry @ each), half) for each in _command_errors(kinematics, lost, columns))
        mapped = np.max(np.abs(matvec(carry, finite.errors)), axis=0)
        plain, corrected = (
            {"lost motion": own, "crosstalk": rest, "linear map": mapped} for own, rest in ((loss, cross), (np.zeros(6), left))
        )
        least = _steps(assembly, kinematics.actuators)
        steps = {} if least is None else {STEPS: matvec(np.abs(carry @ lost.gain.values), 0.5 * least)}
        provenance = f"{lost.provenance}; {finite.provenance}"
    attempts = Attempts()
    resolution = (
        attempts.of("gauge noise", lambda: pose_resolution(mechanism, kinematics)) if forced else pose_resolution(mechanism, kinematics)
    )
    unknown = np.full(6, np.nan)
    seen = unknown if resolution is None else carry @ resolution.inverse.values
    common = {
        "gauge noise": unknown if resolution is None else coverage * np.sqrt(matvec(seen**2, resolution.gauge_noise**2)),
        "quantisation": unknown if resolution is None else matvec(np.abs(seen), 0.5 * resolution.gauge_steps),
        "drift": unknown if warmed is None else np.abs(warmed.of(at).values[..., :, 0]) * np.abs(temperature),
        **steps,
        **({} if noise is None and not forced else _noises(model, at, noise or {}, band, coverage)),
    }
    if resolution is None:
        attempts.missing["quantisation"] = attempts.missing["gauge noise"]
    sources = (*plain, *common)
    units = tuple((unit,) * len(sources) for unit in TWIST_UNITS)
    both = [Matrix(stack([*own.values(), *common.values()]), COMPONENTS, sources, units) for own in (plain, corrected)]
    missing = tuple(name for index, name in enumerate(sources) if np.any(np.isnan(both[0].values[..., index])))
    ground = None if warmed is None else warmed.ground
    reasons = {**attempts.missing, **reasons, **{name: _NO_DENSITY for name in NOISES if name in missing}}
    return ErrorBudget(both[0], both[1], dict(command), temperature, missing, provenance, ground, coverage, reasons)


def _forced_errors(kinematics: Kinematics, model: LinearModel, columns: list[int]) -> Array:
    """Error (..., 6, c) per command of the forces that hold it at rest by the elastic model: C (V^+ C)^+ xi - V xi."""
    gain = np.asarray(static_gain(model, tuple(f"{PLATFORM}.{name}" for name in COMPONENTS), kinematics.thrusts).values)
    inputs = np.linalg.pinv(kinematics.projection @ gain)
    return gain @ inputs[..., columns] - kinematics.motion[..., columns]


def _noises(
    model: LinearModel, at: str, noise: Mapping[str, Spectrum], band: tuple[float, float] | None, coverage: float
) -> dict[str, Array]:
    """`coverage` standard deviations (..., 6) of the motion against the ground by kind of source; NaN without densities."""
    relative = replace(model, rigid_output=np.zeros_like(model.rigid_output))
    outputs = tuple(f"{at}.{name}" for name in COMPONENTS)
    floor = {name: each for name, each in noise.items() if name.startswith(f"{GROUND}.")}
    found: dict[str, Array] = {}
    for kind, own in zip(NOISES, ({name: each for name, each in noise.items() if name not in floor}, floor), strict=True):
        if not own:
            found[kind] = np.full(6, np.nan)
            continue
        ends = default_frequencies(model)[[0, -1]] if band is None else band
        found[kind] = coverage * random_response(relative, outputs, own, (float(ends[0]), float(ends[1]))).rms
    return found


def _command_errors(kinematics: Kinematics, lost: LostMotion, columns: list[int]) -> tuple[Array, Array, Array]:
    """Errors (..., 6, c) per command: own loss, crosstalk, and the residual of the correction gains."""
    strokes = kinematics.mapping.values[..., columns]
    own = np.eye(strokes.shape[-2]) * lost.loss.values
    loss = kinematics.jacobian.values @ (own @ strokes)
    total = kinematics.motion[..., columns] - lost.gain.values @ strokes
    left = kinematics.motion[..., columns] - lost.gain.values @ lost.correction.values[..., columns]
    return loss, total - loss, left


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
