"""Round rods (wire flexures)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import CURVATURE, LENGTH, POSITIVE
from flexstage.parts.freedom import Freedom, others
from flexstage.parts.section import Circle, circle
from flexstage.parts.shape import INNER_MODES, Shaped, reversed_or_none


@dataclass(frozen=True, eq=False)
class Rod(Shaped):
    """A round rod of constant diameter, `length` along x. Intended freedoms: all but the translation along x.

    `inner_modes` is how many of its own bending modes, across y and across z, and of its twist, the lumped model counts. `curvature` is
    that of its blank about z, as of a leaf.
    """

    kind: ClassVar[str] = "rod"
    slender: ClassVar[bool] = True
    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    diameter: Annotated[Number, LENGTH, POSITIVE]
    inner_modes: Annotated[int, INNER_MODES] = 0
    curvature: Annotated[Number, CURVATURE] | None = None

    @property
    def mirrored(self) -> Rod:
        """The rod with its blank bent to the other side."""
        return replace(self, curvature=reversed_or_none(self.curvature)) if self.is_bent else self

    @property
    def is_bent(self) -> bool:
        """Whether it is not straight when it is free."""
        return self.curvature is not None

    @property
    def straight(self) -> Rod:
        """The rod as if it were straight when it is free."""
        return replace(self, curvature=None)

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms the rod is meant to have."""
        return others((Freedom.X,))

    @property
    def span(self) -> Number:
        """Its length [m]."""
        return self.length

    @property
    def throat(self) -> Circle:
        """Its one section, round."""
        return circle(self.diameter)
