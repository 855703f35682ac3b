"""Leaf springs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import Enum
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import CURVATURE, LENGTH, POSITIVE, TEMPERATURE
from flexstage.parts.freedom import Freedom
from flexstage.parts.section import Rectangle
from flexstage.parts.shape import INNER_MODES, Order, Shaped, reversed_or_none


class LeafSection(Enum):
    """What bends in a leaf: a `PLATE`, which its width stiffens, or the `BEAM` that many sources take it for."""

    PLATE = "plate"
    BEAM = "beam"


class LeafEnds(Enum):
    """Whether the bodies at a leaf's ends keep its section from warping as it twists: `CLAMPED`, or `FREE` to warp."""

    CLAMPED = "clamped"
    FREE = "free to warp"


@dataclass(frozen=True, eq=False)
class Leaf(Shaped):
    """A leaf spring: `length` along x, `thickness` along y, `width` along z.

    Intended freedoms: translation along y, bending about z, twist about x. With `section` beam its law leaves plate action out, and its
    ends are free to warp; a plate's are with `ends` free. `inner_modes` is how many of its own bending modes, and of its twist, the lumped
    model counts.

    Where it is not straight when free: `curvature` is that of its blank about z (positive: towards y), `face_temperature_difference`
    is that of its face at +y less that of its face at -y. It is mounted straight, as drawn: large displacements count what that takes,
    other models take it as straight.
    """

    kind: ClassVar[str] = "leaf"
    slender: ClassVar[bool] = True
    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]
    section: LeafSection = LeafSection.PLATE
    inner_modes: Annotated[int, INNER_MODES] = 0
    ends: LeafEnds = LeafEnds.CLAMPED
    curvature: Annotated[Number, CURVATURE] | None = None
    face_temperature_difference: Annotated[Number, TEMPERATURE] | None = None

    @property
    def mirrored(self) -> Leaf:
        """The leaf with its blank bent, and warm, on the other side."""
        warmer = reversed_or_none(self.face_temperature_difference)
        return replace(self, curvature=reversed_or_none(self.curvature), face_temperature_difference=warmer) if self.is_bent else self

    @property
    def is_bent(self) -> bool:
        """Whether it is not straight when it is free."""
        return self.curvature is not None or self.face_temperature_difference is not None

    @property
    def straight(self) -> Leaf:
        """The leaf as if it were straight when it is free."""
        return replace(self, curvature=None, face_temperature_difference=None)

    @property
    def warps(self) -> bool:
        """Whether its ends may warp as it twists."""
        return self.section is LeafSection.BEAM or self.ends is LeafEnds.FREE

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms the leaf is meant to have."""
        return (Freedom.Y, Freedom.RX, Freedom.RZ)

    @property
    def span(self) -> Number:
        """Its length [m]."""
        return self.length

    @property
    def throat(self) -> Rectangle:
        """Its one section."""
        return Rectangle(self.thickness, self.width)

    @property
    def orders(self) -> Iterator[Order]:
        """It is thinner than wide."""
        yield Order("thickness", self.thickness, self.width, "the width", "Exchange them, or turn the link's bends")
