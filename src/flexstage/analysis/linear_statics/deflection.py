"""Deflection of the platform under permanent load: own weight, payloads and specified forces, with strokes fixed."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.linear_statics.lost_motion import LOADED
from flexstage.analysis.loaded.load_effect import load_effect
from flexstage.analysis.workspace.load import dead_loads
from flexstage.base.arguments import check_arguments
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, stack
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import displacement
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS


class Deflection(Result):
    """Twist (..., 6, causes) of the platform's reference point or a named point; causes are own weight, each payload, each force.

    In closed loop, the gauges measure the deflection and the strokes compensate for it. In open loop, the deflection is the load term of
    equation 11 (Shin & Moon).
    """

    point: str
    by_cause: Matrix
    provenance: str

    @property
    def total(self) -> Array:
        """Twist (..., 6) under all loads."""
        return np.sum(self.by_cause.values, axis=-1)


@check_arguments
def deflection(mechanism: Mechanism, model: LinearModel, *, point: str = PLATFORM) -> Deflection:
    """Compute the deflection of a platform point under gravity and specified forces, with strokes fixed.

    If `model` is the model of the loaded stage (see `load_effect`), the deflection is the motion from the unloaded to the loaded
    equilibrium, by the theory of large displacements. The result then has only one cause, `all loads`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> stage = double_triangle()
    >>> bool(deflection(stage, lumped(stage)).by_cause.at("platform.z", "own weight") < 0.0)
    True
    """
    effect = load_effect(mechanism) if LOADED in model.stiffness and not model.designs else None
    rows = tuple(f"{point}.{name}" for name in COMPONENTS)
    if effect is not None and (whole := effect.deflection(point)) is not None:
        unit = tuple((name,) for name in TWIST_UNITS)
        return Deflection(point, Matrix(whole[:, None], rows, ("all loads",), unit), f"{model.provenance}, large displacements")
    causes = dead_loads(mechanism, model)
    motion = displacement(model, stack(list(causes.values())))
    values = model.seen(model.output_index(rows), motion)
    unit = tuple((name,) * len(causes) for name in TWIST_UNITS)
    return Deflection(point, Matrix(values, rows, tuple(causes), unit), model.provenance)
