"""A bipod: two legs of three blades each in one plane, which hold what they carry along themselves and yield to all else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from flexstage.base.number import Number, Vector
from flexstage.base.units.scale import X
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link
from flexstage.parts.body import Body

SIDES: Mapping[str, float] = {"left": 1.0, "right": -1.0}


@dataclass(frozen=True)
class Bipod:
    """Two legs in the plane x = 0, one on either side of z.

    They run from (y, z) = (+-`foot`, `base`) to (+-`head`, `top`); their blades are the part "blade", the middle one of a leg is wide in
    the bipod's plane, the others across it.
    """

    foot: Number
    base: Number
    head: Number
    top: Number

    def bodies(self) -> dict[str, Body]:
        """The knees `low` and `high` of both legs, which weigh nothing."""
        return {f"{name}_{knee}": Body() for name in SIDES for knee in ("low", "high")}

    def links(self, end: str = "") -> dict[str, Link]:
        """The blades `foot`, `middle` and `top` of both legs, from the ground to the platform, or to bodies `left_<end>` and so on."""
        found: dict[str, Link] = {}
        for name, side in SIDES.items():
            joins = (GROUND, f"{name}_low", f"{name}_high", f"{name}_{end}" if end else PLATFORM)
            for number, (blade, wide) in enumerate((("foot", X), ("middle", self._across(side)), ("top", X))):
                start, stop = self.at(side, number / 3.0), self.at(side, (number + 1) / 3.0)
                found[f"{name}_{blade}"] = Link((joins[number], joins[number + 1]), "blade", start=start, end=stop, bends=wide)
        return found

    def at(self, side: float, share: Number) -> Vector:
        """Point of a leg, that `share` of its length from the foot."""
        return (0.0, side * (self.foot - share * (self.foot - self.head)), self.base + share * (self.top - self.base))

    def _across(self, side: float) -> Vector:
        return (0.0, self.top - self.base, side * (self.foot - self.head))
