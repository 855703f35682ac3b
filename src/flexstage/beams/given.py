"""Parts known by a 6x6 matrix."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array, stack
from flexstage.beams.law import PartLaw
from flexstage.parts.given import Given


def given_compliance(part: Given) -> Array:
    """The stated compliance (..., 6, 6) about the centre.

    >>> given_compliance(Given(tuple(tuple(float(i == j) for j in range(6)) for i in range(6)), free=())).trace()
    np.float64(6.0)
    """
    return stack(part.compliance)


def given_mass(part: Given) -> Array:
    """Half of the stated mass at each end (..., 12, 12), both at the part's centre: a given part has no length and no rotary inertia.

    >>> given_mass(Given(tuple(tuple(float(i == j) for j in range(6)) for i in range(6)), free=(), mass=4.0)).diagonal()[:4].tolist()
    [2.0, 2.0, 2.0, 0.0]
    """
    pattern = np.zeros((12, 12))
    pattern[[0, 1, 2, 6, 7, 8], [0, 1, 2, 6, 7, 8]] = 0.5
    return np.asarray(part.mass)[..., None, None] * pattern


GIVEN = PartLaw(compliance=given_compliance, mass=given_mass)
