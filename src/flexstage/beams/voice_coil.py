"""Voice coils: the magnets' stiffness and the damping along x, both sides' masses."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.force_actuator import point_masses
from flexstage.beams.law import PartLaw
from flexstage.parts.voice_coil import CoilSide, VoiceCoil

_AXIAL: Array = np.diag(np.eye(6)[0])


def _axial(value: Number) -> Array:
    """A 6x6 with one entry, along x."""
    return np.asarray(value)[..., None, None] * _AXIAL


def _mass(part: VoiceCoil) -> Array:
    sides = (part.mass, part.magnet_mass)
    return point_masses(*(sides if part.coil is CoilSide.FIRST else sides[::-1]))


VOICE_COIL = PartLaw(
    stiffness=lambda part: _axial(part.stiffness), damping=lambda part: _axial(part.viscous_damping), mass=_mass, needs_material=False
)
