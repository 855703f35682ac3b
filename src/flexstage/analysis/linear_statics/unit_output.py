"""Output properties of an isolated unit, for any model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np

from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.base.record import INNER, Heading
from flexstage.base.units.quantity import RATIO, STIFFNESS


@dataclass(frozen=True, eq=False)
class UnitOutput:
    """Output properties of one isolated unit, in its own frame.

    `unit` is the unit's name; `copy` is the analysed instance. `direction` (3,) is the direction of the output; `stiffness` is the 6x6
    stiffness at the output with strokes fixed. With the output guided along `direction`, `gain` is the output motion divided by the stroke,
    and `ideal_gain` is this gain without elasticity.
    """

    unit: str
    copy: str
    direction: Annotated[Array, RATIO]
    stiffness: Matrix
    gain: float
    ideal_gain: float

    @cached_property
    def axial(self) -> Annotated[float, STIFFNESS, Heading("axial stiffness")]:
        """Stiffness along the output direction n with all other DOFs fixed [N/m]: n^T K n, with the translational stiffness K.

        >>> values = np.diag([10.0, 2.0, 3.0, 1.0, 1.0, 1.0])
        >>> stiffness = Matrix(values, tuple("abcdef"), tuple("abcdef"), "N/m")
        >>> unit = UnitOutput("drive", "B1", np.array([1.0, 0.0, 0.0]), stiffness, 0.9, 1.0)
        >>> unit.axial, unit.lateral
        (10.0, (2.0, 3.0))
        """
        return float(self.direction @ self._translations @ self.direction)

    @cached_property
    def lateral(self) -> Annotated[tuple[float, float], STIFFNESS]:
        """Least and largest stiffness perpendicular to the output direction [N/m], with all other DOFs fixed."""
        across = np.linalg.svd(self.direction[None, :])[2][1:]
        softest, stiffest = np.linalg.eigvalsh(across @ self._translations @ across.T)
        return float(softest), float(stiffest)

    @property
    def softest_lateral(self) -> Annotated[float, INNER, STIFFNESS, Heading("softest lateral", varying=True)]:
        """Least stiffness perpendicular to the output direction [N/m]."""
        return self.lateral[0]

    @property
    def stiffest_lateral(self) -> Annotated[float, INNER, STIFFNESS, Heading("stiffest lateral", varying=True)]:
        """Largest stiffness perpendicular to the output direction [N/m]."""
        return self.lateral[1]

    @property
    def _translations(self) -> Array:
        return self.stiffness.values[:3, :3]

    @property
    def figures(self) -> Mapping[str, float]:
        """Values for the comparison of models [SI]."""
        return {
            "axial stiffness": self.axial,
            "softest lateral stiffness": self.lateral[0],
            "stiffest lateral stiffness": self.lateral[1],
            "gain": self.gain,
        }
