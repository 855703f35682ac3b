"""Springs by their stated stiffness."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.law import PartLaw
from flexstage.parts.spring import Spring


def spring_mass(part: Spring) -> Array:
    """Consistent mass (..., 12, 12) of a straight line of uniform mass between its ends, at +-L/2 from the centre; without length, there.

    Its points move as s between the ends, v = (1 - s) v_a + s v_b: m/3 at each end, m/6 between them, so that a spring held at one end adds
    a third of its mass to the other.

    >>> spring_mass(Spring(stiffness=1.0, mass=6.0))[0, [0, 6]].tolist()
    [2.0, 1.0]
    """
    half = 0.5 * np.asarray(0.0 if part.length is None else part.length)
    first, second = _end(-half), _end(half)
    ends = np.concatenate([first, np.zeros_like(first)], axis=-1), np.concatenate([np.zeros_like(second), second], axis=-1)
    own, mixed = (np.swapaxes(one, -1, -2) @ other for one, other in ((ends[0], ends[0]), (ends[0], ends[1])))
    other = np.swapaxes(ends[1], -1, -2) @ ends[1]
    return np.asarray(part.mass)[..., None, None] * ((own + other) / 3.0 + (mixed + np.swapaxes(mixed, -1, -2)) / 6.0)


def _end(arm: Array) -> Array:
    """Displacement (..., 3, 6) at x = `arm` (...) per twist at the centre."""
    across = np.zeros((3, 6))
    across[1, 5], across[2, 4] = 1.0, -1.0
    return np.eye(3, 6) + arm[..., None, None] * across


SPRING = PartLaw(stiffness=lambda part: part.whole, mass=spring_mass)
