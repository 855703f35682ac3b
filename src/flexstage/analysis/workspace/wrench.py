"""Stress resultants at the links over a box of strokes, with permanent load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.analysis.workspace.load import dead_loads
from flexstage.analysis.workspace.stroke import StrokeLimits
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array, matvec
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import displacement, static_gain
from flexstage.spatial.frame import FORCES


@dataclass(frozen=True, eq=False)
class Command:
    """Command of platform coordinates x: the inputs (..., n) are `start` + `mapping` x."""

    mapping: Matrix
    start: Array


def corner_wrenches(
    mechanism: Mechanism, model: LinearModel, limits: StrokeLimits, links: tuple[str, ...], command: Command | None = None
) -> Array:
    """Compute link wrenches (k, ..., L, 6) [N, N m] at all k = 2^n corners of the strokes, under permanent load.

    Each wrench acts from the second body on the link, in the link's frame at its centre (tension is positive). The wrench is linear in the
    strokes, so convex functions of the wrench (stress, force) are largest at a corner. With a `command`, `limits` apply to the command's
    coordinates.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> from flexstage.analysis.workspace.stroke import stroke_limits
    >>> stage = double_triangle()
    >>> corner_wrenches(stage, lumped(stage), stroke_limits(stage), ("B1/front",)).shape
    (64, 1, 6)
    """
    names = tuple(f"{link}.{force}" for link in links for force in FORCES)
    gain = static_gain(model, names, limits.actuators if command is None else command.mapping.rows).values
    dead = dead_wrenches(mechanism, model, names)
    if command is not None:
        dead = dead + matvec(gain, command.start)
        gain = gain @ command.mapping.part(command.mapping.rows, limits.actuators).values
    total = matvec(gain, limits.points(max(gain.ndim - 2, dead.ndim - 1))) + dead
    return total.reshape(*total.shape[:-1], len(links), len(FORCES))


def dead_wrenches(mechanism: Mechanism, model: LinearModel, outputs: tuple[str, ...]) -> Array:
    """Compute the named outputs (..., p) under weight and specified forces, with strokes fixed.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> stage = double_triangle()
    >>> bool(dead_wrenches(stage, lumped(stage), ("platform.z",)) < 0)
    True
    """
    load = sum(dead_loads(mechanism, model).values(), np.zeros(len(model.coordinates)))
    motion = displacement(model, load[..., None])
    return model.seen(model.output_index(outputs), motion)[..., 0]
