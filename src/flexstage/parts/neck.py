"""Two-axis neck hinges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.parts.freedom import ROTATIONS, Freedom
from flexstage.parts.profile import Profile
from flexstage.parts.section import Rectangle, Section, circle
from flexstage.parts.shape import Profiled


@dataclass(frozen=True, eq=False)
class Neck(Profiled):
    """Two-axis neck hinge: round (without `width`: `thickness` is the diameter; a toroid for a circular profile), or rectangular.

    A rectangular neck has `thickness` along y and `width` along z, both increased by the profile. Ideal degrees of freedom: the three
    rotations (torsion is free although its stiffness is used; locked, it would transmit a couple).
    """

    kind: ClassVar[str] = "neck"
    material: str
    thickness: Annotated[Number, LENGTH, POSITIVE]
    profile: Profile
    width: Annotated[Number, LENGTH, POSITIVE] | None = None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom."""
        return ROTATIONS

    def grown(self, up: Number) -> Section:
        """Section at a profile height `up` [m], on all sides."""
        height = self.thickness + 2.0 * up
        return circle(height) if self.width is None else Rectangle(height, self.width + 2.0 * up)
