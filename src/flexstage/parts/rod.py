"""Round rods (wire flexures)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from flexstage.base.digest import Description
from flexstage.base.number import Number
from flexstage.base.quantity import LENGTH, POSITIVE
from flexstage.parts.freedom import Freedom, others


@dataclass(frozen=True, eq=False)
class Rod(Description):
    """A round rod of constant diameter, `length` along x. Intended freedoms: all but the translation along x."""

    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    diameter: Annotated[Number, LENGTH, POSITIVE]

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms the rod is meant to have."""
        return others((Freedom.X,))
