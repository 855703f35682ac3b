"""Inertia of a placed body together with its payloads."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array, stack
from flexstage.mechanism.assembly.expand import PlacedBody
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.mass import MassProperties, tensor
from flexstage.spatial.frame import rigid_inertia


def carried_masses(mechanism: Mechanism, placed: PlacedBody) -> tuple[MassProperties, ...]:
    """Return the mass properties of the body (if it has mass) and of each of its payloads, in the stage's frame.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> stage = double_triangle()
    >>> len(carried_masses(stage, expand(stage).bodies["platform"]))
    1
    """
    loads = [
        MassProperties(np.asarray(load.mass), stack(load.at), np.zeros((3, 3)) if load.inertia is None else tensor(load.inertia))
        for load in mechanism.payloads.values()
        if load.body == placed.name
    ]
    return tuple(loads) if placed.mass is None else (placed.mass, *loads)


def moving_inertia(mechanism: Mechanism, placed: PlacedBody) -> Array | None:
    """Compute the inertia (..., 6, 6) of the body with payloads about its reference point, in the stage's axes; `None` without mass.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> stage = double_triangle()
    >>> round(float(moving_inertia(stage, expand(stage).bodies["platform"])[0, 0]), 4)
    13.9965
    """
    items = carried_masses(mechanism, placed)
    if not items:
        return None
    return sum((rigid_inertia(item.mass, item.inertia, item.centre, placed.reference) for item in items), np.zeros((6, 6)))
