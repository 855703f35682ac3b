"""One-axis notch hinges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.parts.freedom import Freedom
from flexstage.parts.profile import Profile
from flexstage.parts.section import Rectangle
from flexstage.parts.shape import Order, Profiled


@dataclass(frozen=True, eq=False)
class Notch(Profiled):
    """One-axis notch hinge that bends about z: x along the hinge, y across the thin neck (`thickness`), z along the `width`."""

    kind: ClassVar[str] = "notch"
    material: str
    thickness: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]
    profile: Profile

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom."""
        return (Freedom.RZ,)

    def grown(self, up: Number) -> Rectangle:
        """Return the cross-section where the profile has the height `up` [m]; the width is constant."""
        return Rectangle(self.thickness + 2.0 * up, self.width)

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the neck is thinner than wide."""
        yield Order("thickness", self.thickness, self.width, "the width", "Exchange both values, or rotate the link's bends")
        yield from super().orders
