"""Static errors in open loop: with the ideal mapping, with gains that correct lost motion, and with gains of another model."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np

from flexstage.analysis.complete import read
from flexstage.analysis.linear_statics.deflection import deflection
from flexstage.analysis.linear_statics.lost_motion import LostMotion, lost_motion
from flexstage.base.finding import DesignError
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array, first_design
from flexstage.base.record import VIEW
from flexstage.base.units.quantity import LENGTH
from flexstage.control.compensation import StaticError, ideal_compensation, lost_motion_compensation, static_error
from flexstage.control.study.resolve import ResolvedSetup
from flexstage.models.theory import Model


@dataclass(frozen=True, eq=False)
class RestErrors(InNotebook):
    """Static errors of a stage with strokes from the ideal kinematics (`ideal_map`), or corrected for lost motion (`lost_motion_gains`).

    `other_gains` is the static error with the lost-motion gains of `other_model` (`None` if this model does not apply). `load` (6,) [m,
    rad] is the platform's deflection under all its loads with fixed actuators. `load_strokes` (n,) [m] are the strokes that cancel this
    deflection as far as possible; `load_left` (6,) is the remaining deflection.
    """

    ideal_map: StaticError
    lost_motion_gains: StaticError
    other_gains: StaticError | None
    other_model: Model
    load: Annotated[Array, VIEW]
    load_left: Annotated[Array, VIEW]
    load_strokes: Annotated[Array, LENGTH]


def rest_errors(given: ResolvedSetup, lost: LostMotion) -> RestErrors:
    """Compute the static errors of a completed set-up.

    >>> from flexstage.analysis.linear_statics.lost_motion import lost_motion
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.control.study.resolve import resolve
    >>> from flexstage.control.study.setup import LoopSetup
    >>> given = resolve(double_triangle(), LoopSetup())
    >>> found = rest_errors(given, lost_motion(given.kinematics, given.model))
    >>> round(found.ideal_map.error.at("z", "z").item(), 3), found.lost_motion_gains.largest < 1e-9
    (0.032, True)
    """
    kinematics, (other, model) = given.kinematics, _other_gains(given)
    # strokes at an operating point are relative to its deflection
    load = np.zeros(6) if given.displaced else np.real(first_design(deflection(given.mechanism, given.model).total, 1))
    carrying = lost_motion_compensation(lost, kinematics, load)
    error = partial(static_error, kinematics=kinematics, plant=lost.gain, deflection=load)
    return RestErrors(
        ideal_map=error(ideal_compensation(kinematics)),
        lost_motion_gains=error(lost_motion_compensation(lost, kinematics)),
        other_gains=None if other is None else error(lost_motion_compensation(other, kinematics)),
        other_model=model,
        load=load,
        load_left=error(carrying).offset,
        load_strokes=carrying.offset,
    )


def _other_gains(given: ResolvedSetup) -> tuple[LostMotion | None, Model]:
    other = Model.MAPPED if given.setup.model is Model.LUMPED else Model.LUMPED
    if given.displaced:
        return None, other
    try:
        linear = read(given.mechanism, other)
        return (None if linear is None else lost_motion(given.kinematics, linear)), other
    except DesignError:
        return None, other
