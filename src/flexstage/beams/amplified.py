"""Amplified actuators and stepping drives: the 6x6 that they state, half of mass and inertia at each face."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.force_actuator import point_masses
from flexstage.beams.law import PartLaw
from flexstage.parts.amplified import Amplified
from flexstage.parts.mass import tensor


def amplified_mass(part: Amplified) -> Array:
    """Half of the stated mass and inertia (..., 12, 12) at each face, both at the part's centre.

    >>> amplified_mass(Amplified(stroke=1e-4, mass=2.0)).diagonal()[:4].tolist()
    [1.0, 1.0, 1.0, 0.0]
    """
    lumps = point_masses(0.5 * part.mass, 0.5 * part.mass)
    if part.inertia is None:
        return lumps
    own = 0.5 * tensor(part.inertia)
    result = np.zeros((*np.broadcast_shapes(lumps.shape[:-2], own.shape[:-2]), 12, 12), dtype=np.result_type(lumps, own)) + lumps
    for start in (3, 9):
        result[..., start : start + 3, start : start + 3] += own
    return result


AMPLIFIED = PartLaw(stiffness=lambda part: part.between, mass=amplified_mass, needs_material=False)
STEPPER = PartLaw(
    stiffness=lambda part: part.between, mass=lambda part: point_masses(0.5 * part.mass, 0.5 * part.mass), needs_material=False
)
