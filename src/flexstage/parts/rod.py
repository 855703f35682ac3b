"""Round rods (wire flexures)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import CURVATURE, LENGTH, POSITIVE
from flexstage.parts.freedom import Freedom, others
from flexstage.parts.section import Circle, circle
from flexstage.parts.shape import INNER_MODES, Shaped


@dataclass(frozen=True, eq=False)
class Rod(Shaped):
    """Round rod (wire flexure) of constant diameter, `length` along x. Ideal degrees of freedom: all except translation along x.

    The lumped model has `inner_modes` bending modes in y, the same number of bending modes in z, and the same number of torsion modes.
    `curvature` is the initial curvature about z of the free rod, as for a leaf.
    """

    kind: ClassVar[str] = "rod"
    slender: ClassVar[bool] = True
    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    diameter: Annotated[Number, LENGTH, POSITIVE]
    inner_modes: Annotated[int, INNER_MODES] = 0
    curvature: Annotated[Number, CURVATURE] | None = None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom."""
        return others((Freedom.X,))

    @property
    def span(self) -> Number:
        """Length [m]."""
        return self.length

    @property
    def throat(self) -> Circle:
        """Constant round section."""
        return circle(self.diameter)
