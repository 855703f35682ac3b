"""A leaf that is thinnest in its middle, with straight flanks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.parts.freedom import Freedom
from flexstage.parts.section import Rectangle
from flexstage.parts.shape import Order, Shaped


@dataclass(frozen=True, eq=False)
class Taper(Shaped):
    """A leaf of `length` along x and `width` along z, `thickness` thick in its middle and `end_thickness` at both ends."""

    kind: ClassVar[str] = "taper"
    slender: ClassVar[bool] = True
    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    end_thickness: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Those of a leaf."""
        return (Freedom.Y, Freedom.RX, Freedom.RZ)

    @property
    def span(self) -> Number:
        """Its length [m]."""
        return self.length

    @property
    def throat(self) -> Rectangle:
        """The section in its middle."""
        return Rectangle(self.thickness, self.width)

    @property
    def end(self) -> Rectangle:
        """The section at its ends."""
        return Rectangle(self.end_thickness, self.width)

    @property
    def is_prismatic(self) -> bool:
        """It has flanks."""
        return False

    @property
    def orders(self) -> Iterator[Order]:
        """Thinnest in its middle, and thinner than wide."""
        yield Order("thickness", self.thickness, self.end_thickness, "the end_thickness", "Exchange both values")
        yield Order("end_thickness", self.end_thickness, self.width, "the width", "Exchange both values, or rotate the link's bends")
