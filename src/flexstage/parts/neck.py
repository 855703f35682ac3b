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
    """A two-axis hinge: round (`width` absent: `thickness` is the diameter; with a circular profile a toroid), or rectangular.

    A rectangular neck is `thickness` thick along y and `width` wide along z, both grown by the profile. Intended freedoms: the three
    rotations (its torsion counts as free although its stiffness is used: with it locked every strut passes a couple about its axis).
    """

    kind: ClassVar[str] = "neck"
    material: str
    thickness: Annotated[Number, LENGTH, POSITIVE]
    profile: Profile
    width: Annotated[Number, LENGTH, POSITIVE] | None = None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms the hinge is meant to have."""
        return ROTATIONS

    def grown(self, up: Number) -> Section:
        """The section where the cuts have risen by `up` [m], on all sides."""
        height = self.thickness + 2.0 * up
        return circle(height) if self.width is None else Rectangle(height, self.width + 2.0 * up)
