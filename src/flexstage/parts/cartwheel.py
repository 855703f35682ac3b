"""Cartwheel hinges: two pairs of leaves in series, connected by a hub."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.number import Number
from flexstage.base.units.quantity import ANGLE, LENGTH, MASS, NOT_NEGATIVE, POSITIVE
from flexstage.parts.body import Body, Inertia
from flexstage.parts.compound import FIRST, SECOND, Composition, Compound, Member, radial_leaf
from flexstage.parts.freedom import Freedom
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.shape import INNER_MODES, Order


@dataclass(frozen=True, eq=False)
class Cartwheel(Compound):
    """Cartwheel hinge about z: four leaves of `length` as spokes, two from the first body to a hub, two from the hub to the second body.

    The link's origin is the hub's centre. The x axis points from the first body to the second and bisects both pairs of leaves. `angle` is
    the angle between the leaves of a pair. The leaves end at the circumference of the rigid hub, whose diameter d is `hub_diameter`. The
    hub has the inertia of a disc with mass `hub_mass` m, diameter d and the leaves' width b: I_z = m d^2 / 8, I_x = I_y = m (d^2 / 16 + b^2
    / 12).
    """

    kind: ClassVar[str] = "cartwheel"
    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]
    angle: Annotated[Number, ANGLE, POSITIVE]
    hub_diameter: Annotated[Number, LENGTH, NOT_NEGATIVE] = 0.0
    hub_mass: Annotated[Number, MASS, NOT_NEGATIVE] | None = None
    section: LeafSection = LeafSection.PLATE
    inner_modes: Annotated[int, INNER_MODES] = 0

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degree of freedom: rotation about z."""
        return (Freedom.RZ,)

    @property
    def composition(self) -> Composition:
        """Leaves `first_left`, `first_right`, `second_left`, `second_right` (left is +y), and the body `hub`."""
        along, across = np.cos(0.5 * self.angle), np.sin(0.5 * self.angle)
        centre = 0.5 * (self.hub_diameter + self.length)
        leaf = Leaf(self.material, self.length, self.thickness, self.width, self.section, self.inner_modes)

        def spoke(side: float) -> Member:
            return radial_leaf(leaf, ("hub", SECOND), (along, side * across), centre=centre)

        def inward(side: float) -> Member:
            return radial_leaf(leaf, (FIRST, "hub"), (along, side * across), centre=-centre)

        members = {"first_left": inward(-1.0), "first_right": inward(1.0), "second_left": spoke(1.0), "second_right": spoke(-1.0)}
        return Composition(members, {"hub": self._hub})

    @property
    def _hub(self) -> Body:
        if self.hub_mass is None:
            return Body(reference=(0.0, 0.0, 0.0))
        squared, across = self.hub_diameter * self.hub_diameter, self.width * self.width / 12.0
        tilting = self.hub_mass * (squared / 16.0 + across)
        return Body(mass=self.hub_mass, inertia=Inertia(tilting, tilting, self.hub_mass * squared / 8.0))

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the leaves are thinner than wide, and the angle between the leaves of a pair is below pi."""
        yield Order("angle", self.angle, np.pi, "a straight angle", "Use the angle between the leaves of a pair", ANGLE)
        yield Order("thickness", self.thickness, self.width, "the width", "Exchange both values, or rotate the link's bends")
