"""Bare force actuators: no stiffness, half of their mass on each body."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.law import PartLaw
from flexstage.parts.force_actuator import ForceActuator


def point_masses(first: Number, second: Number) -> Array:
    """Masses (..., 12, 12) that the two bodies carry at a part's centre [kg], without rotary inertia.

    >>> point_masses(1.0, 2.0).diagonal().tolist()
    [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0]
    """
    along = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    ends = np.broadcast_arrays(*(np.asarray(mass)[..., None] * along for mass in (first, second)))
    return np.concatenate(ends, axis=-1)[..., None] * np.eye(12)


def _force_mass(part: ForceActuator) -> Array:
    return point_masses(0.5 * part.mass, 0.5 * part.mass)


FORCE_ACTUATOR = PartLaw(stiffness=lambda _: np.zeros((6, 6)), mass=_force_mass, needs_material=False)
