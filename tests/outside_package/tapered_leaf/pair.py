"""Two leaves side by side: a compound."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.parts.compound import FIRST, SECOND, Composition, Compound, Member
from flexstage.parts.leaf import Leaf


@dataclass(frozen=True, eq=False)
class BladePair(Compound):
    """Two parallel leaves of `length`, at a `distance` along y."""

    kind: ClassVar[str] = "blade_pair"
    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]
    distance: Annotated[Number, LENGTH, POSITIVE]

    @property
    def composition(self) -> Composition:
        """`low` and `high`."""
        leaf = Leaf(self.material, self.length, self.thickness, self.width)
        half = 0.5 * self.distance
        places = {"low": -half, "high": half}
        return Composition({name: Member(leaf, (FIRST, SECOND), (0.0, y, 0.0), along=(1.0, 0.0, 0.0)) for name, y in places.items()})
