"""Errors at rest in open loop: by the ideal map alone, with gains that correct lost motion, by gains of another model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.analysis.complete import read
from flexstage.analysis.deflection import deflection
from flexstage.analysis.lost_motion import LostMotion, lost_motion
from flexstage.base.finding import DesignError
from flexstage.base.number import Array, first_design
from flexstage.control.compensation import StaticError, compensated, static_error, uncompensated
from flexstage.control.study.settle import Settled
from flexstage.models.theory import Model


@dataclass(frozen=True, eq=False)
class RestErrors:
    """Errors at rest of the stage by its model: commanded by R_a (`bare`), and by the gains of the same model (`corrected`).

    `other` is what gains of the `other_model` leave on it (`None` where that model does not have the stage). `load` (6,) is the twist
    of the platform under all its loads, strokes held, `carried` (6,) what of it no stroke takes back, `strokes` (n,) [m] those that take
    back the rest.
    """

    bare: StaticError
    corrected: StaticError
    other: StaticError | None
    other_model: Model
    load: Array
    carried: Array
    strokes: Array


def rest_errors(given: Settled, lost: LostMotion) -> RestErrors:
    """Errors at rest of a settled set-up.

    >>> from flexstage.analysis.lost_motion import lost_motion
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.control.study.settle import settled
    >>> from flexstage.control.study.setup import LoopSetup
    >>> given = settled(double_triangle(), LoopSetup())
    >>> found = rest_errors(given, lost_motion(given.kinematics, given.model))
    >>> round(found.bare.error.at("z", "z").item(), 3), found.corrected.largest < 1e-9
    (0.032, True)
    """
    kinematics = given.kinematics
    load = np.real(first_design(deflection(given.mechanism, given.model).total, 1))
    carrying = compensated(lost, kinematics, load)
    other, model = _other(given)
    return RestErrors(
        bare=static_error(uncompensated(kinematics), kinematics, lost.gain, load),
        corrected=static_error(compensated(lost, kinematics), kinematics, lost.gain, load),
        other=None if other is None else static_error(compensated(other, kinematics), kinematics, lost.gain, load),
        other_model=model,
        load=load,
        carried=static_error(carrying, kinematics, lost.gain, load).offset,
        strokes=carrying.offset,
    )


def _other(given: Settled) -> tuple[LostMotion | None, Model]:
    other = Model.MAPPED if given.setup.model is Model.LUMPED else Model.LUMPED
    try:
        linear = read(given.mechanism, other)
        return (None if linear is None else lost_motion(given.kinematics, linear)), other
    except DesignError:
        return None, other
