"""Round rods (wire flexures)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.quantity import LENGTH, POSITIVE
from flexstage.parts.freedom import Freedom, others
from flexstage.parts.shape import INNER_MODES, Section, Shaped, circle


@dataclass(frozen=True, eq=False)
class Rod(Shaped):
    """A round rod of constant diameter, `length` along x. Intended freedoms: all but the translation along x.

    `inner_modes` is how many of its own bending modes, across y and across z, and of its twist, the lumped model counts.
    """

    kind: ClassVar[str] = "rod"
    slender: ClassVar[bool] = True
    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    diameter: Annotated[Number, LENGTH, POSITIVE]
    inner_modes: Annotated[int, INNER_MODES] = 0

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms the rod is meant to have."""
        return others((Freedom.X,))

    @property
    def span(self) -> Number:
        """Its length [m]."""
        return self.length

    @property
    def throat(self) -> Section:
        """Its one section, round."""
        return circle(self.diameter)
