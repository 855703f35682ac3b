"""Error budget: every source of pose error for a box of displacements and a temperature change, with a row per axis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Annotated

import numpy as np

from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Number, matvec, stack
from flexstage.base.record import INNER, VIEW
from flexstage.base.units.quantity import TEMPERATURE
from flexstage.mechanism.assembly.expansion import Ground
from flexstage.models.linear.kinematics import Kinematics
from flexstage.spatial.frame import COMPONENTS, MOTION, TWIST_UNITS

STEPS = "actuator steps"
PARASITIC = "parasitic motion"
"""Name of the source "parasitic motion" of a force-driven stage, which replaces lost motion, crosstalk and linear map."""
NOISES = ("actuator noise", "floor vibration")
SOURCES = ("lost motion", "crosstalk", "linear map", "gauge noise", "quantisation", "drift")


class ErrorBudget(Result):
    """Largest errors by axis (rows) and source (columns) [m, rad], with the `ideal` mapping and with `corrected` lost motion.

    `missing` names unknown sources (e.g. unspecified gauge noise), which are NaN and omitted from the sums. `ground` is the ground material
    assumed for drift, and `coverage` is the number of standard deviations of gauge noise. `reasons` explain unknown sources. For a
    force-driven stage, `ideal` and `corrected` are equal, because the elastic model gives the forces.
    """

    ideal: Matrix
    corrected: Matrix
    command: Annotated[Mapping[str, Number], MOTION]
    temperature: Annotated[Number, TEMPERATURE]
    missing: tuple[str, ...]
    provenance: str
    ground: Ground | None = None
    coverage: float = 3.0
    reasons: Mapping[str, str] = field(default_factory=dict[str, str])

    @property
    def forced(self) -> Annotated[bool, INNER]:
        """Whether forces drive the stage."""
        return PARASITIC in self.ideal.columns

    @property
    def sums(self) -> Annotated[Matrix, VIEW]:
        """Sums of the errors of all sources by axis (rows): linear and root-sum-square sums of `ideal` and of `corrected` (columns)."""
        columns = [
            function(matrix.values)
            for matrix in (self.ideal, self.corrected)
            for function in (lambda values: np.nansum(values, axis=-1), lambda values: np.sqrt(np.nansum(values**2, axis=-1)))
        ]
        names = ("linear", "rss", "linear corrected", "rss corrected")
        return Matrix(np.stack(columns, axis=-1), COMPONENTS, names, tuple((unit,) * 4 for unit in TWIST_UNITS))


def command_columns(kinematics: Kinematics, command: Mapping[str, Number]) -> list[int]:
    """Return the indices of the columns of R_a that belong to the coordinates of a command.

    R_a contains the strokes per platform motion. Raises `DesignError` for unknown coordinates.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> command_columns(ideal(double_triangle()), {"z": 1e-6})
    [2]
    """
    known = kinematics.coordinates
    require(
        Finding(f"command {name}", f"unknown ideal motion (expected {', '.join(known) or 'none'})", suggest_nearest(name, known))
        for name in command
        if name not in known
    )
    return [known.index(name) for name in command]


def command_strokes(kinematics: Kinematics, command: Mapping[str, Number], *, depth: int = 0) -> Array:
    """Compute the strokes a = R_a xi, shape (2^c, ..., n) [m], at the corners of a box of displacements xi along c coordinates.

    R_a is the ideal mapping from platform motion to strokes. `depth` is the least number of batch axes between the corners and the strokes.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> command_strokes(ideal(double_triangle()), {"x": 1e-6, "z": 3e-6}).shape
    (4, 6)
    """
    columns = command_columns(kinematics, command)
    half = stack([command[name] for name in command]) if command else np.zeros(0)
    signs = 2.0 * ((np.arange(2 ** len(columns))[:, None] >> np.arange(len(columns))) & 1) - 1.0
    mapping = kinematics.mapping.values[..., columns]
    lead = (len(signs), *(1,) * max(depth, mapping.ndim - 2, half.ndim - 1), len(columns))
    return matvec(mapping, signs.reshape(lead) * half)
