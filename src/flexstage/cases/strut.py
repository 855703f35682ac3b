"""A strut: a piezo stack between two round necks, so that it pushes along its line and yields to everything else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from flexstage.base.number import Number, Vector
from flexstage.base.units.scale import mm
from flexstage.mechanism.mechanism import Link, Unit
from flexstage.parts.body import Body, Cylinder
from flexstage.parts.neck import Neck
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import length as hinge_length

ADAPTER = 5 * mm
"""Thickness of the plates between a stack and its necks."""


@dataclass(frozen=True)
class Strut:
    """A strut: its front neck centred at `head`, pushing along the unit vector `along`; adapters of `material`, `adapter` in diameter."""

    head: Vector
    along: Vector
    neck: Neck
    stack: Piezo
    material: str
    adapter: Number

    @property
    def length(self) -> Number:
        """Distance between the centres of the necks: half necks, adapters and the stack [m]."""
        return hinge_length(self.neck.profile) + 2.0 * ADAPTER + self.stack.length

    @property
    def foot(self) -> Vector:
        """Centre of the back neck."""
        return self.at(self.length)

    def at(self, distance: Number) -> Vector:
        """Point on the strut's line, `distance` behind the head."""
        x, y, z = (point - distance * slope for point, slope in zip(self.head, self.along, strict=True))
        return x, y, z

    def bodies(self) -> Mapping[str, Body]:
        """The adapters `base` and `tip`."""
        inset = 0.5 * (hinge_length(self.neck.profile) + ADAPTER)
        places = {"base": self.at(self.length - inset), "tip": self.at(inset)}
        plates = {name: Cylinder(self.material, self.adapter, ADAPTER, at, self.along) for name, at in places.items()}
        return {name: Body(solids={"plate": plate}) for name, plate in plates.items()}

    def links(self, joins: tuple[str, str], parts: tuple[str, str] = ("neck", "stack")) -> Mapping[str, Link]:
        """The neck `back` on `joins[0]`, the stack `pzt`, the neck `front` on `joins[1]`; `parts` names neck and stack."""
        return {
            "back": Link((joins[0], "base"), parts[0], self.foot, self.along),
            "pzt": Link(("base", "tip"), parts[1], self.at(0.5 * self.length), self.along),
            "front": Link(("tip", joins[1]), parts[0], self.head, self.along),
        }

    def unit(self, joins: tuple[str, str] = ("ground", "platform")) -> Unit:
        """The strut as a unit of its own."""
        return Unit(bodies=self.bodies(), links=self.links(joins))
