"""Motions of the stage's bodies in the measured modes, from outputs that have the names of gauges or motions of the stage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.number import Array, first_design
from flexstage.base.record import VIEW
from flexstage.base.units.dimension import dimension_of
from flexstage.base.units.quantity import RATIO
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.records.record import Channel, names_of
from flexstage.experiment.records.unit import unit_problem
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.linear.kinematics import Kinematics
from flexstage.spatial.frame import COMPONENTS

_RANK = 1e-6


@dataclass(frozen=True, eq=False)
class StageShapes:
    """Measured shapes as motions of the stage.

    `motions` maps each body's name to the body's twists (6, k) [m, rad] in the k modes. `used` lists the outputs from which the motions are
    computed. `explained` (k,) is the fraction of each measured shape that ideal motion explains. `explained` is 1 if there are no more
    outputs than degrees of freedom. If the shapes cannot be mapped to the stage, `missing` is the reason.
    """

    motions: Mapping[str, Array]
    used: tuple[str, ...]
    explained: Annotated[Array, RATIO]
    missing: str | None = None

    @property
    def twists(self) -> Annotated[tuple[Mapping[str, float], ...] | None, VIEW]:
        """Platform twist [m, rad] in each mode."""
        found = self.motions.get(PLATFORM)
        return None if found is None else tuple(dict(zip(COMPONENTS, column.tolist(), strict=True)) for column in found.T)


def stage_shapes(kinematics: Kinematics, found: Identified) -> StageShapes:
    """Fit ideal stage motions to the measured shapes s by least squares: the platform twists are x = V (R V)^+ s.

    The columns of V are the ideal motions, and (R V)^+ is the pseudo-inverse. Each row of R maps the platform twist to an output: to a
    gauge's reading (a row of the matrix R_s) or to a component of a body's twist. Rotations are multiplied by the characteristic length of
    the kinematics. For six gauges the result equals R_s^-1 s (Eq. 14 of Shin & Moon). All bodies move with the ideal kinematics: hinges are
    free about their intended axes.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> stage_shapes(ideal(double_triangle()), identify(one_mode_record())).missing
    'no output of the record (y) has the name of a gauge or of a motion of the stage'
    """
    rows = {channel.name: row for channel in found.outputs if (row := _row(kinematics, channel.name)) is not None}
    if not rows:
        names = ", ".join(names_of(found.outputs[:8]))
        return _missing_shapes(f"no output of the record ({names}) has the name of a gauge or of a motion of the stage")
    chosen = [index for index, channel in enumerate(found.outputs) if channel.name in rows]
    weight = np.array([kinematics.first_length if _is_rotation(kinematics, name) else 1.0 for name in rows])
    scale = np.array([1.0 / kinematics.first_length if name.startswith("r") else 1.0 for name in kinematics.coordinates])
    seen = weight[:, None] * np.stack(list(rows.values())) * scale
    rank = int(np.linalg.matrix_rank(seen, tol=_RANK * float(np.linalg.norm(seen, 2))))
    if rank < kinematics.mobility:
        return _missing_shapes(f"{', '.join(rows)} measure only {rank} of the {kinematics.mobility} motions of the platform")
    measured = weight[:, None] * si_shapes(found)[chosen]
    motion = np.linalg.lstsq(seen, measured, rcond=None)[0]
    rest = np.sum((measured - seen @ motion) ** 2, axis=0) / np.maximum(np.sum(measured**2, axis=0), 1e-300)
    twists = _twists(kinematics, scale[:, None] * motion)
    return StageShapes(twists, tuple(rows), 1.0 - rest)


def si_shapes(found: Identified, names: Sequence[str] | None = None) -> Array:
    """Convert the real shapes (p, k) to SI units, for all outputs or for the outputs `names`; outputs may have different units.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> si_shapes(identify(one_mode_record())).tolist()
    [[1e-06]]
    """
    shapes = np.array([si_factor(channel) for channel in found.outputs])[:, None] * found.real_shapes
    if names is None:
        return shapes
    return shapes[[names_of(found.outputs).index(name) for name in names]]


def si_factor(channel: Channel) -> float:
    """Return the factor from a channel's unit to the SI unit (1e-6 for um); 1 for an unknown unit.

    >>> si_factor(Channel("S1", "um")), si_factor(Channel("S1"))
    (1e-06, 1.0)
    """
    return float(dimension_of(channel.unit).size) if unit_problem(channel.unit) is None else 1.0


def _row(kinematics: Kinematics, name: str) -> Array | None:
    """Row of an output over the platform's coordinates (f,); None for other names than the stage's."""
    if name in kinematics.gauges:
        return first_design(kinematics.sensing, 2)[kinematics.gauges.index(name)] @ first_design(kinematics.motion, 2)
    owner, _, component = name.rpartition(".")
    if owner == PLATFORM and component in COMPONENTS:
        return first_design(kinematics.motion, 2)[COMPONENTS.index(component)]
    if name in kinematics.body_coordinates:
        return first_design(kinematics.bodies, 2)[kinematics.body_coordinates.index(name)]
    return None


def _is_rotation(kinematics: Kinematics, name: str) -> bool:
    if name in kinematics.gauges:
        return kinematics.reading_units[kinematics.gauges.index(name)] == "rad"
    return name.rpartition(".")[2] in COMPONENTS[3:]


def _twists(kinematics: Kinematics, motion: Array) -> dict[str, Array]:
    moved = first_design(kinematics.bodies, 2) @ motion
    names = dict.fromkeys(name.rpartition(".")[0] for name in kinematics.body_coordinates)
    rows = {name: [kinematics.body_coordinates.index(f"{name}.{component}") for component in COMPONENTS] for name in names}
    return {name: moved[index] for name, index in rows.items()} | {PLATFORM: first_design(kinematics.motion, 2) @ motion}


def _missing_shapes(reason: str) -> StageShapes:
    return StageShapes({}, (), np.zeros(0), reason)
