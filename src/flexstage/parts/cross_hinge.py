"""Cross-axis flexural pivots: leaves that cross at an angle, in parallel planes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.number import Number
from flexstage.base.units.quantity import ANGLE, LENGTH, POSITIVE, RATIO
from flexstage.parts.compound import FIRST, SECOND, Composition, Compound, Member, radial_leaf
from flexstage.parts.freedom import Freedom
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.shape import INNER_MODES, Order


@dataclass(frozen=True, eq=False)
class CrossHinge(Compound):
    """Cross-axis flexural pivot about z: two leaves cross at an `angle`; the `length` of each leaf is from the first to the second body.

    The link's origin is the crossing, x the bisector of both leaves. `crossing` is the distance from the first body to the crossing divided
    by the length (Wittrick's lambda). `spacing` is the distance along z between the middle planes of adjacent leaves. With a
    `middle_width`, the pivot has three leaves: a middle leaf of this width, and a leaf of `width` on either side.
    """

    kind: ClassVar[str] = "cross_hinge"
    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]
    spacing: Annotated[Number, LENGTH, POSITIVE]
    angle: Annotated[Number, ANGLE, POSITIVE] = 0.5 * np.pi
    crossing: Annotated[Number, RATIO] = 0.5
    middle_width: Annotated[Number, LENGTH, POSITIVE] | None = None
    section: LeafSection = LeafSection.PLATE
    inner_modes: Annotated[int, INNER_MODES] = 0

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degree of freedom: rotation about z."""
        return (Freedom.RZ,)

    @property
    def composition(self) -> Composition:
        """Leaves of the pivot: `left` and `right`; with a `middle_width`, `left_low`, `left_high`, and the middle leaf `right`."""
        along, across = np.cos(0.5 * self.angle), np.sin(0.5 * self.angle)
        centre = (0.5 - self.crossing) * self.length
        leaf = Leaf(self.material, self.length, self.thickness, self.width, self.section, self.inner_modes)

        def member(part: Leaf, side: float, height: Number) -> Member:
            return radial_leaf(part, (FIRST, SECOND), (along, side * across), centre=centre, height=height)

        if self.middle_width is None:
            return Composition({"left": member(leaf, 1.0, -0.5 * self.spacing), "right": member(leaf, -1.0, 0.5 * self.spacing)})
        return Composition(
            {
                "left_low": member(leaf, 1.0, -self.spacing),
                "left_high": member(leaf, 1.0, self.spacing),
                "right": member(replace(leaf, width=self.middle_width), -1.0, 0.0),
            }
        )

    @property
    def orders(self) -> Iterator[Order]:
        """Required: leaves are thinner than wide, cross each other, and do not interfere."""
        yield Order("angle", self.angle, np.pi, "a straight angle", "Use the angle between the leaves", ANGLE)
        yield Order("thickness", self.thickness, self.width, "the width", "Exchange both values, or rotate the link's bends")
        middle = self.width if self.middle_width is None else self.middle_width
        yield Order("thickness", self.thickness, middle, "the middle width", "Make the middle leaf wider")
        yield Order("width", 0.5 * (self.width + middle), self.spacing, "the spacing", "Increase the spacing of the leaves", strict=False)
