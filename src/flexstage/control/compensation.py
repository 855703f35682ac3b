"""Compensation of lost motion and permanent loads in open loop: static gains, strokes, and the residual static error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.analysis.linear_statics.lost_motion import LostMotion
from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.models.linear.kinematics import Kinematics
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS


@dataclass(frozen=True, eq=False)
class Compensation:
    """Open-loop compensation: the strokes a for a commanded pose xi are a = `gains` xi + `offset`.

    `gains` (n, f) map f pose coordinates to n strokes: the matrix R_a of the ideal kinematics, or gains that correct lost motion. `offset`
    (n,) [m] are the strokes that balance the loads. `provenance` names the model.
    """

    gains: Matrix
    offset: Array
    provenance: str

    def strokes(self, poses: Array) -> Array:
        """Compute strokes (..., n) [m] for poses (..., f) [m, rad]."""
        return np.asarray(poses) @ self.gains.values.T + self.offset


def ideal_compensation(kinematics: Kinematics) -> Compensation:
    """Compute the strokes a = R_a xi for a pose xi with the matrix R_a of the ideal kinematics (Eq. 13 of Shin & Moon).

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.ideal import ideal
    >>> ideal_compensation(ideal(parallelogram())).strokes(np.array([2e-6])).tolist()
    [2e-06]
    """
    return Compensation(kinematics.mapping, np.zeros(len(kinematics.actuators)), kinematics.provenance)


def lost_motion_compensation(lost: LostMotion, kinematics: Kinematics, deflection: Array | None = None) -> Compensation:
    """Compute gains that correct lost motion, and strokes that cancel the platform's `deflection` (6,) under loads.

    The strokes a for a pose xi are a = (R_a V^+ T)^-1 R_a (xi - V^+ C w). This is Eq. 11 of Shin & Moon with the load term, solved for a.
    R_a maps poses to ideal strokes, V^+ projects twists onto the ideal motions, and T is the elastic twist per stroke. C w is the
    `deflection`: the twist of the platform's reference point with all strokes zero (`analysis.deflection`, or the static compliance C times
    a wrench w). Strokes cannot cancel deflections outside the ideal motions. The computation is linear. Raises `DesignError` for a
    deflection without exactly 6 components.

    >>> from flexstage.analysis.linear_statics.lost_motion import lost_motion
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> stage = parallelogram()
    >>> lost = lost_motion(ideal(stage), lumped(stage))
    >>> found = lost_motion_compensation(lost, ideal(stage), np.array([1e-6, 0, 0, 0, 0, 0]))
    >>> round(float(found.strokes(np.array([1e-6]))[0]), 15)  # what the load does already needs no stroke
    0.0
    """
    gains = lost.correction
    if deflection is None:
        return Compensation(gains, np.zeros(len(gains.rows)), lost.provenance)
    twist = np.asarray(deflection)
    if twist.shape != (6,):
        raise refuse(
            "deflection", f"not a twist (got shape {twist.shape}, expected 6 components)", "Use the platform's twist for a single design"
        )
    return Compensation(gains, -gains.values @ (kinematics.projection @ twist), lost.provenance)


@dataclass(frozen=True, eq=False)
class StaticError(InNotebook):
    """Static error in open loop: `error` (f, f) is the commanded minus the reached pose, per unit of the commanded pose.

    Each row of `error` belongs to a reached coordinate, each column to a commanded coordinate. The diagonal elements are the errors of the
    axes, the other elements are crosstalk. `parasitic` (6, f) is the motion outside the ideal motions, per unit of the commanded pose.
    `offset` (6,) is the twist that remains at zero command under the loads. `largest` is the largest error per unit of command in all six
    directions, with rotations converted to lengths.
    """

    error: Matrix
    parasitic: Matrix
    offset: Array
    largest: float
    provenance: str

    def of(self, command: Array) -> Array:
        """Compute the error (..., f) [m, rad] for commanded poses (..., f), without loads."""
        return np.asarray(command) @ self.error.values.T


def static_error(given: Compensation, kinematics: Kinematics, plant: Matrix, deflection: Array | None = None) -> StaticError:
    """Compute the static error of a compensation for a plant described by any model.

    The error is E = I - V^+ T G. G are the gains, V^+ projects twists onto the ideal motions, and `plant` is the matrix T (6, n): the
    platform's twist per stroke (`lost_motion(...).gain`, or `static_gain` of any model). For the ideal gains G = R_a, the error is E =
    R_a^+ Lambda R_a, where Lambda is the lost motion (`lost_motion(...).loss`). `deflection` (6,) is the plant's deflection under the loads
    with all strokes zero. Raises `DesignError` if the plant has other actuators than the compensation.

    >>> from flexstage.analysis.linear_statics.lost_motion import lost_motion
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> stage = double_triangle()
    >>> kinematics, lost = ideal(stage), lost_motion(ideal(stage), lumped(stage))
    >>> round(static_error(ideal_compensation(kinematics), kinematics, lost.gain).error.at("z", "z").item(), 3)
    0.032
    >>> static_error(lost_motion_compensation(lost, kinematics), kinematics, lost.gain).largest < 1e-9
    True
    """
    if plant.columns != given.gains.rows or len(plant.rows) != len(COMPONENTS):
        what = f"wrong actuators (got {', '.join(plant.columns)}, expected {', '.join(given.gains.rows)})"
        raise refuse("plant", what, "Use the platform's twist per stroke of these actuators")
    names, length = kinematics.coordinates, kinematics.first_length
    reached = plant.values @ given.gains.values
    error = np.eye(len(names)) - kinematics.projection @ reached
    units = tuple(TWIST_UNITS[COMPONENTS.index(name)] for name in names)
    left = np.zeros(6) if deflection is None else np.asarray(deflection)
    return StaticError(
        error=Matrix(error, names, names, ratio_units(units, units)),
        parasitic=Matrix(reached - kinematics.motion @ (np.eye(len(names)) - error), COMPONENTS, names, ratio_units(TWIST_UNITS, units)),
        offset=left + plant.values @ given.offset,
        largest=_largest(kinematics.motion - reached, names, length),
        provenance=f"gains by {given.provenance}",
    )


def _largest(missing: Array, names: tuple[str, ...], length: float) -> float:
    """Largest entry of motions (6, f) with rotations as lengths."""
    rows, columns = (np.array([length if name.startswith("r") else 1.0 for name in group]) for group in (COMPONENTS, names))
    return float(np.max(np.abs(missing * rows[:, None] / columns), initial=0.0))
