"""One-axis notch hinges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from flexstage.base.digest import Description
from flexstage.base.number import Number
from flexstage.base.quantity import LENGTH, POSITIVE
from flexstage.parts.freedom import Freedom
from flexstage.parts.profile import Profile


@dataclass(frozen=True, eq=False)
class Notch(Description):
    """A one-axis hinge: link frame x along the hinge, y across the thin neck (`thickness`), z along the `width`; it bends about z.

    Intended freedom: the rotation about z.
    """

    material: str
    thickness: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]
    profile: Profile

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms the hinge is meant to have."""
        return (Freedom.RZ,)
