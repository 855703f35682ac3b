"""Leaf springs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import CURVATURE, LENGTH, POSITIVE, TEMPERATURE
from flexstage.parts.freedom import Freedom
from flexstage.parts.section import Rectangle
from flexstage.parts.shape import INNER_MODES, Order, Shaped


class LeafSection(Enum):
    """Bending theory of a leaf: a `PLATE`, stiffened by its width, or a `BEAM`."""

    PLATE = "plate"
    BEAM = "beam"


class LeafEnds(Enum):
    """Warping of a leaf's ends in torsion: `CLAMPED` (prevented) or `FREE`."""

    CLAMPED = "clamped"
    FREE = "free to warp"


@dataclass(frozen=True, eq=False)
class Leaf(Shaped):
    """Leaf spring: `length` along x, `thickness` along y, `width` along z.

    Ideal degrees of freedom: translation along y, bending about z, twist about x. For the section `BEAM`, the stiffness law omits plate
    action and restrained warping. For a plate with `FREE` ends, the stiffness law omits only restrained warping. The lumped model has
    `inner_modes` bending modes and the same number of torsion modes.

    If the free leaf is not straight, specify its initial `curvature` about z (positive: towards y) or `face_temperature_difference` (face
    +y minus face -y). The initially bent leaf is mounted straight. Models of large displacements include the mounting stress; other models
    assume a straight leaf.
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
    def warps(self) -> bool:
        """Whether the ends of the leaf may warp in torsion."""
        return self.section is LeafSection.BEAM or self.ends is LeafEnds.FREE

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom."""
        return (Freedom.Y, Freedom.RX, Freedom.RZ)

    @property
    def span(self) -> Number:
        """Length [m]."""
        return self.length

    @property
    def throat(self) -> Rectangle:
        """Cross-section, constant over the length."""
        return Rectangle(self.thickness, self.width)

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the leaf is thinner than wide."""
        yield Order("thickness", self.thickness, self.width, "the width", "Exchange both values, or rotate the link's bends")
