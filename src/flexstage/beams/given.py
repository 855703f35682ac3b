"""Parts known by a 6x6 matrix."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array, stack
from flexstage.beams.law import PartLaw
from flexstage.parts.given import Given
from flexstage.parts.mass import tensor
from flexstage.spatial.frame import rigid_inertia


def given_compliance(part: Given) -> Array:
    """The stated compliance (..., 6, 6) about the centre.

    >>> given_compliance(Given(tuple(tuple(float(i == j) for j in range(6)) for i in range(6)), free=())).trace()
    np.float64(6.0)
    """
    return stack(part.compliance)


def given_mass(part: Given) -> Array:
    """Half of the stated mass at each end (..., 12, 12), both at the part's centre: a given part has no length.

    It has no rotary inertia but what is stated: then half of the rigid solid moves with each end.

    >>> given_mass(Given(tuple(tuple(float(i == j) for j in range(6)) for i in range(6)), free=(), mass=4.0)).diagonal()[:4].tolist()
    [2.0, 2.0, 2.0, 0.0]
    """
    if part.inertia is not None or part.centre is not None:
        inertia = np.zeros((3, 3)) if part.inertia is None else tensor(part.inertia)
        solid = rigid_inertia(part.mass, inertia, stack(part.centre or (0.0, 0.0, 0.0)), np.zeros(3))
        none = np.zeros_like(solid)
        return 0.5 * np.concatenate([np.concatenate([solid, none], axis=-1), np.concatenate([none, solid], axis=-1)], axis=-2)
    pattern = np.zeros((12, 12))
    pattern[[0, 1, 2, 6, 7, 8], [0, 1, 2, 6, 7, 8]] = 0.5
    return np.asarray(part.mass)[..., None, None] * pattern


GIVEN = PartLaw(compliance=given_compliance, mass=given_mass)
