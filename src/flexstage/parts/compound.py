"""Compound hinges: assemblies of other parts, which replace the compound at expansion.

A new kind derives from `Compound` and returns its `composition`. Models, analyses, pictures and finite elements use only the members; the
compound has no stiffness law or shape.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from flexstage.base.number import Number, Vector
from flexstage.parts.body import Body
from flexstage.parts.leaf import Leaf
from flexstage.parts.shape import Elastic

FIRST, SECOND = "first", "second"
"""Names that the members use for the two bodies joined by the link."""
_Z = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Member:
    """Member of a compound: its part, the two bodies that it `joins` (`first`, `second` or inner bodies), its pose in the compound."""

    part: Elastic
    joins: tuple[str, str]
    at: Vector
    along: Vector
    bends: Vector = _Z


@dataclass(frozen=True, eq=False)
class Composition:
    """Composition of a compound: `members`, and inner `bodies` in the compound's frame. Bodies without a specified mass are massless."""

    members: Mapping[str, Member]
    bodies: Mapping[str, Body] = field(default_factory=dict)


class Compound(Elastic):
    """Compound part, replaced by its members at expansion. Members of the link `B1/pivot` are named `B1/pivot.left`, ...

    The numeric fields of a compound have addresses like those of any part; their values may be arrays or complex numbers. Equal members
    should be the same object, so that their stiffness law is computed only once.
    """

    @property
    def is_axisymmetric(self) -> bool:
        """False, because the members are on different sides of the x axis."""
        return False

    @property
    def mirrored(self) -> Compound:
        """The same compound, because each member is mirrored individually."""
        return self

    @property
    def composition(self) -> Composition:
        """Members and inner bodies."""
        raise NotImplementedError


def radial_leaf(leaf: Leaf, joins: tuple[str, str], direction: tuple[Number, Number], *, centre: Number, height: Number = 0.0) -> Member:
    """Return a leaf as member of a compound, along a unit `direction` (x, y) from the compound's z axis.

    The leaf's middle is at the distance `centre` [m] from the axis and at z = `height` [m]. The leaf bends about z.

    >>> radial_leaf(Leaf("steel", 0.02, 0.001, 0.01), ("first", "second"), (0.0, 1.0), centre=0.015).at
    (0.0, 0.015, 0.0)
    """
    x, y = direction
    return Member(leaf, joins, (centre * x, centre * y, height), (x, y, 0.0))
