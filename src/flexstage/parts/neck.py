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
    """Two-axis neck hinge, round or rectangular. The neck's thickness varies along x according to the `profile`.

    Without `width` the neck is round: `thickness` is its smallest diameter, and a circular profile gives a toroid. A rectangular neck has
    `thickness` along y and `width` along z; both increase towards the ends according to the profile. Ideal degrees of freedom: the three
    rotations. In the ideal model, torsion is free, because locked torsion would transmit a couple. The elastic models use the torsional
    stiffness.
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
        """Return the cross-section where the profile has the height `up` [m]; this height is added on all sides."""
        height = self.thickness + 2.0 * up
        return circle(height) if self.width is None else Rectangle(height, self.width + 2.0 * up)
