"""Blocked forces: force-displacement lines of the stacks against the stage stiffness, and of the platform against external loads."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.workspace.stroke import StrokeLimits, stroke_actuators
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import Result
from flexstage.base.number import Array, magnitude, matvec, stack
from flexstage.base.record import VIEW, Along, Heading, Layout
from flexstage.base.units.quantity import DISPLACEMENT, FORCE, STIFFNESS
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import static_gain
from flexstage.spatial.frame import COMPONENTS, FORCES, MOTION, WRENCH


class StackLine(Result):
    """Force-displacement lines (..., n) of single stacks that push against the stage while all other strokes are zero.

    `free` displacement [m] and `blocking` force [N] are the ends of the stack's line; `stiffness` [N/m] is the stack's stiffness.
    `stage_stiffness` [N/m] is the stiffness of the stage between the ends of the stack, with other strokes fixed. `travel` [m] and `force`
    [N] (compression) are the intersection of the stack's line with the stage's line.
    """

    TABLE: ClassVar[Layout] = Layout("Stacks pushing against the stage")

    actuators: tuple[str, ...]
    free: Annotated[Array, DISPLACEMENT, Along("actuators"), Heading("free displacement", digits=4)]
    travel: Annotated[Array, DISPLACEMENT, Along("actuators"), Heading("displacement in the stage", digits=4)]
    blocking: Annotated[Array, FORCE, Along("actuators"), Heading("blocked force", digits=4)]
    force: Annotated[Array, FORCE, Along("actuators"), Heading("force in the stage", digits=4)]
    stiffness: Annotated[Array, STIFFNESS, Along("actuators"), Heading("own stiffness", digits=4)]
    stage_stiffness: Annotated[Array, STIFFNESS, Along("actuators"), Heading("stage stiffness", digits=4)]
    provenance: str


class PlatformLine(Result):
    """Force-displacement lines (..., f) of the platform along each coordinate, for strokes by the ideal mapping.

    `travel` [m, rad] is the largest motion without load, equal in both directions; `stiffness` [N/m, N m/rad] is for a load along this
    coordinate only. `blocking` [N, N m] is the blocked force: the load that returns the platform to zero.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Forces of the platform",
        "table",
        notes=("The displacement along a coordinate ends where an actuator reaches its limit; the load acts only along this coordinate.",),
    )

    coordinates: tuple[str, ...]
    travel: Array
    stiffness: Array
    blocking: Array
    provenance: str

    @property
    def table(self) -> Annotated[Matrix, VIEW, Heading(digits=4)]:
        """Table of the coordinates (rows) with travel, stiffness and blocked force."""
        moves = list(map(MOTION.unit, self.coordinates))
        loads = list(map(WRENCH.unit, self.coordinates))
        slopes = ratio_units(tuple(loads), tuple(moves))
        units = tuple((move, slopes[index][index], load) for index, (move, load) in enumerate(zip(moves, loads, strict=True)))
        values = np.stack([self.travel, self.stiffness, self.blocking], axis=-1)
        return Matrix(values, self.coordinates, ("travel", "stiffness", "blocking"), units)


def stack_lines(mechanism: Mechanism, model: LinearModel) -> StackLine:
    """Compute the intersection of each stack's line F = k (u - s) with the stage's line F = k_s s.

    F is the force, s the displacement, u the free stroke; k and k_s are the stiffnesses of stack and stage. The model gives the force per
    free stroke, k k_s / (k + k_s), from which k_s follows.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> stage = double_triangle()
    >>> line = stack_lines(stage, lumped(stage))
    >>> bool(np.allclose(line.force / line.blocking + line.travel / line.free, 1.0))
    True
    """
    assembly = expand(mechanism)
    links = tuple(assembly.strokes.values())
    names = tuple(assembly.strokes)
    strokes = [assembly.actuator(name).free_deformation for name in names]
    slope = -stack([_along(model, link, name, free) for (name, link), free in zip(assembly.strokes.items(), strokes, strict=True)])
    laws = [model.stiffness[link].law[..., :6, :6] for link in links]
    own = stack([np.sum(matvec(law, along) * along, axis=-1) for law, along in zip(laws, strokes, strict=True)])
    free = stack([part.stroke for part in stroke_actuators(mechanism).values()])
    against = slope * own / (own - slope)
    return StackLine(
        actuators=names,
        free=np.broadcast_to(free, slope.shape),
        blocking=own * free,
        stiffness=own,
        stage_stiffness=against,
        travel=free * own / (own + against),
        force=free * slope,
        provenance=model.provenance,
    )


def _along(model: LinearModel, link: str, name: str, free: Array) -> Array:
    """The link's force (...) along its free deformation per unit stroke."""
    places = np.flatnonzero(np.any(np.reshape(free, (-1, 6)), axis=0))
    forces = static_gain(model, tuple(f"{link}.{FORCES[place]}" for place in places), (name,)).values[..., 0]
    return np.sum(forces * free[..., places], axis=-1)


def platform_lines(mapping: Matrix, model: LinearModel, limits: StrokeLimits) -> PlatformLine:
    """Compute force-displacement lines of the platform at its reference point; `mapping` is the same as for `single_axis`.

    The strokes for coordinate j end where the first actuator reaches its limit. The travel is the elastic motion for these strokes; it
    includes lost motion. The load acts only along coordinate j; the other coordinates are free, so the stiffness is 1 / C_jj, with the
    compliance C.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> from flexstage.analysis.workspace.stroke import stroke_limits
    >>> stage = double_triangle()
    >>> line = platform_lines(ideal(stage).mapping, lumped(stage), stroke_limits(stage))
    >>> bool(np.allclose(line.blocking, line.travel * line.stiffness))
    True
    """
    twist = tuple(f"{PLATFORM}.{name}" for name in mapping.columns)
    wrench = tuple(f"{PLATFORM}.{FORCES[COMPONENTS.index(name)]}" for name in mapping.columns)
    gain = static_gain(model, twist, mapping.rows).values @ mapping.values
    compliance = static_gain(model, twist, wrench).values
    available = np.minimum(-limits.low, limits.high)
    share = magnitude(mapping.values)
    none = share == 0.0
    reach = np.min(np.where(none, np.inf, available[..., :, None] / np.where(none, 1.0, share)), axis=-2)
    travel = reach * np.linalg.diagonal(gain)
    stiffness = 1.0 / np.linalg.diagonal(compliance)
    return PlatformLine(mapping.columns, travel, stiffness, travel * stiffness, model.provenance)
