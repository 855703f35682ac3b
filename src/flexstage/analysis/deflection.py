"""Deflection of the platform under dead load: own weight, payloads and stated forces, strokes held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.analysis.workspace.load import applied
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array, stack
from flexstage.mechanism.mechanism import PLATFORM, Force, Mechanism
from flexstage.readings.linear.model import LinearModel
from flexstage.readings.linear.static import displacement
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

OWN_WEIGHT = "own weight"


@dataclass(frozen=True, eq=False)
class Deflection:
    """Twist (..., 6, causes) of the platform's reference, or of a named point, by cause: own weight, each payload, each stated force.

    Under a controlled stage the gauges see it and the strokes take it back; in open loop it is Eq. 11's load term.
    """

    point: str
    by_cause: Matrix
    provenance: str

    @property
    def total(self) -> Array:
        """Twist (..., 6) under everything at once."""
        return np.sum(self.by_cause.values, axis=-1)


def deflection(mechanism: Mechanism, model: LinearModel, *, point: str = PLATFORM) -> Deflection:
    """Deflection at a point of the platform under gravity and stated forces: q = K^-1 f, strokes held, small displacements.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.readings.lumped import lumped
    >>> stage = double_triangle()
    >>> bool(deflection(stage, lumped(stage)).by_cause.at("platform.z", "own weight") < 0.0)
    True
    """
    gravity = stack(mechanism.gravity)
    everything = model.base_inertia[..., :3] @ gravity
    carried = {name: _weight(mechanism, model, name) for name in mechanism.payloads}
    forces = {name: applied(mechanism, model, force) for name, force in mechanism.forces.items()}
    own = everything - sum(carried.values(), np.zeros(len(model.coordinates)))
    causes = {OWN_WEIGHT: own, **{f"payload {name}": load for name, load in carried.items()}, **forces}
    motion = displacement(model, np.stack(np.broadcast_arrays(*causes.values()), axis=-1))
    rows = tuple(f"{point}.{name}" for name in COMPONENTS)
    values = model.output[..., model.output_index(rows), :] @ motion
    unit = tuple((name,) * len(causes) for name in TWIST_UNITS)
    return Deflection(point, Matrix(values, rows, tuple(causes), unit), model.provenance)


def _weight(mechanism: Mechanism, model: LinearModel, name: str) -> Array:
    load = mechanism.payloads[name]
    x, y, z = (load.mass * component for component in mechanism.gravity)
    return applied(mechanism, model, Force(load.body, load.at, (x, y, z)))
