"""Leaf springs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from flexstage.base.digest import Description
from flexstage.base.number import Number
from flexstage.base.quantity import LENGTH, POSITIVE
from flexstage.parts.freedom import Freedom


@dataclass(frozen=True, eq=False)
class Leaf(Description):
    """A leaf spring: `length` along x, `thickness` along y, `width` along z.

    Intended freedoms: translation along y, bending about z, twist about x.
    """

    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms the leaf is meant to have."""
        return (Freedom.Y, Freedom.RX, Freedom.RZ)
