"""Error budget: every source of pose error for a stated command and temperature change, on one line an axis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from flexstage.analysis.linear_statics.lost_motion import LostMotion
from flexstage.analysis.workspace.gauging import PoseResolution
from flexstage.analysis.workspace.map_error import MapError
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Number, stack
from flexstage.base.record import VIEW
from flexstage.base.units.quantity import TEMPERATURE
from flexstage.mechanism.assembly.expansion import Ground
from flexstage.models.linear.kinematics import Kinematics
from flexstage.spatial.frame import COMPONENTS, MOTION, TWIST_UNITS, transport

STEPS = "actuator steps"
SOURCES = ("lost motion", "crosstalk", "linear map", "gauge noise", "quantisation", "drift")


@dataclass(frozen=True, eq=False)
class Evidence:
    """The results an error budget is drawn from.

    `map_error` holds the corners of the command (see `command_strokes`); `drift` (6 x fields) is the motion of the point of interest per
    field, of `Drift.of` (strokes held) or `held_by_gauges` (`None`: not known, as `reasons` say by source); `arm` (..., 3) [m] leads from
    the platform's reference to that point; `steps` (..., n) [m] are those of actuators that move in steps (`None`: none; NaN: unknown).
    """

    kinematics: Kinematics
    lost_motion: LostMotion
    map_error: MapError
    resolution: PoseResolution
    drift: Matrix | None
    arm: Array
    ground: Ground | None = None
    reasons: Mapping[str, str] = field(default_factory=dict[str, str])
    steps: Array | None = None


class ErrorBudget(Result):
    """Largest errors by axis (rows) and source (columns) [m, rad], commanded by the ideal mapping, and with the lost-motion gains.

    `missing` names sources that could not be counted (no gauge noise stated): they are NaN and left out of the sums. `ground` is what drift
    took it to be of; `coverage` how many standard deviations of gauge noise count. `reasons` say why a source is not known.
    """

    ideal: Matrix
    corrected: Matrix
    command: Annotated[Mapping[str, Number], MOTION]
    temperature: Annotated[Number, TEMPERATURE]
    missing: tuple[str, ...]
    provenance: str
    ground: Ground | None = None
    coverage: float = 3.0
    reasons: Mapping[str, str] = field(default_factory=dict[str, str])

    @property
    def sums(self) -> Annotated[Matrix, VIEW]:
        """Rows are the axes; columns the linear and root-sum-square sums of both commands."""
        columns = [
            function(matrix.values)
            for matrix in (self.ideal, self.corrected)
            for function in (lambda values: np.nansum(values, axis=-1), lambda values: np.sqrt(np.nansum(values**2, axis=-1)))
        ]
        names = ("linear", "rss", "linear corrected", "rss corrected")
        return Matrix(np.stack(columns, axis=-1), COMPONENTS, names, tuple((unit,) * 4 for unit in TWIST_UNITS))


def error_budget(evidence: Evidence, command: Mapping[str, Number], *, temperature: Number = 0.0, coverage: float = 3.0) -> ErrorBudget:
    """Error budget over a box of commands (half widths by coordinate [m, rad]) and a uniform temperature change [K].

    Lost motion J diag(Lambda) R_a xi, crosstalk J (Lambda - diag) R_a xi with the motion outside the ideal ones; with the gains
    a = (R_a V^+ T)^-1 R_a xi only T a - V xi is left, counted as crosstalk. Linear map: finite less linear kinematics at the corners.
    Noise: `coverage` standard deviations. Quantisation: half a step of every gauge with the worst signs. Actuators that move in steps: half
    a step of each alike, in a column that other stages do not have (evenly spread, it has a standard deviation of step/sqrt(12)). Largest
    absolute values.

    >>> from flexstage.analysis.assessment.budget import budget
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = budget(double_triangle(), {"z": 10e-6}, temperature=0.01)
    >>> round(1e9 * float(found.ideal.at("z", "quantisation")), 3)
    5.0
    """
    columns = command_columns(evidence.kinematics, command)
    half = stack([command[name] for name in command]) if command else np.zeros(0)
    carry = transport(evidence.arm)
    loss, cross, left = _command_errors(evidence, columns, carry)
    bent = np.max(np.abs((carry @ evidence.map_error.errors[..., None])[..., 0]), axis=0)
    noise, step = coverage * _random(evidence.resolution, carry), _resolution_errors(evidence.resolution, carry)
    warmed = np.full(6, np.nan) if evidence.drift is None else np.abs(evidence.drift.values[..., :, 0]) * np.abs(temperature)
    stepped = (
        () if evidence.steps is None else ((np.abs(carry @ evidence.lost_motion.gain.values) @ (0.5 * evidence.steps)[..., None])[..., 0],)
    )
    common = (bent, noise, step, warmed, *stepped)
    rows = {
        False: (_largest(loss, half), _largest(cross, half), *common),
        True: (np.zeros(6), _largest(left, half), *common),
    }
    found = {key: _table(values) for key, values in rows.items()}
    missing = tuple(name for index, name in enumerate(found[False].columns) if np.any(np.isnan(found[False].values[..., index])))
    provenance = f"{evidence.lost_motion.provenance}; {evidence.map_error.provenance}"
    return ErrorBudget(
        found[False], found[True], dict(command), temperature, missing, provenance, evidence.ground, coverage, evidence.reasons
    )


def command_columns(kinematics: Kinematics, command: Mapping[str, Number]) -> list[int]:
    """Columns of R_a that a command names; raises `DesignError` for names the stage has not.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> command_columns(ideal(double_triangle()), {"z": 1e-6})
    [2]
    """
    known = kinematics.coordinates
    require(
        Finding(f"command {name}", f"the stage's ideal motions are {', '.join(known) or 'none'}", suggest_nearest(name, known))
        for name in command
        if name not in known
    )
    return [known.index(name) for name in command]


def command_strokes(kinematics: Kinematics, command: Mapping[str, Number], *, depth: int = 0) -> Array:
    """Strokes (2^c, ..., n) [m] at the corners of a box of commands over c coordinates, a = R_a xi; `depth` least batch axes between.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> command_strokes(ideal(double_triangle()), {"x": 1e-6, "z": 3e-6}).shape
    (4, 6)
    """
    columns = command_columns(kinematics, command)
    half = stack([command[name] for name in command]) if command else np.zeros(0)
    signs = 2.0 * ((np.arange(2 ** len(columns))[:, None] >> np.arange(len(columns))) & 1) - 1.0
    mapping = kinematics.mapping.values[..., columns]
    lead = (len(signs), *(1,) * max(depth, mapping.ndim - 2, half.ndim - 1), len(columns))
    return (mapping @ (signs.reshape(lead) * half)[..., None])[..., 0]


def _command_errors(evidence: Evidence, columns: list[int], carry: Array) -> tuple[Array, Array, Array]:
    """Errors (..., 6, c) per command: own loss, the rest, and what the correction gains leave."""
    kinematics, lost = evidence.kinematics, evidence.lost_motion
    strokes = kinematics.mapping.values[..., columns]
    own = np.eye(strokes.shape[-2]) * lost.loss.values
    loss = kinematics.jacobian.values @ (own @ strokes)
    total = kinematics.motion[..., columns] - lost.gain.values @ strokes
    left = kinematics.motion[..., columns] - lost.gain.values @ lost.correction.values[..., columns]
    return carry @ loss, carry @ (total - loss), carry @ left


def _largest(slopes: Array, half: Array) -> Array:
    return (np.abs(slopes) @ np.abs(half)[..., None])[..., 0]


def _random(resolution: PoseResolution, carry: Array) -> Array:
    """Standard deviation (..., 6) of the pose at the point from the gauges' noise."""
    return np.sqrt((((carry @ resolution.inverse.values) ** 2) @ (resolution.gauge_noise**2)[..., None])[..., 0])


def _resolution_errors(resolution: PoseResolution, carry: Array) -> Array:
    return (np.abs(carry @ resolution.inverse.values) @ (0.5 * resolution.gauge_steps)[..., None])[..., 0]


def _table(columns: tuple[Array, ...]) -> Matrix:
    values = stack(list(columns))
    sources = (*SOURCES, STEPS)[: len(columns)]
    return Matrix(values, COMPONENTS, sources, tuple((unit,) * len(sources) for unit in TWIST_UNITS))
