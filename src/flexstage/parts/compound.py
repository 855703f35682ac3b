"""Compound hinges: assemblies of other parts, which replace them at expansion, without their own law and shape.

A new kind derives from `Compound` and returns its `composition`; models, analyses, pictures and finite elements use its members only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from flexstage.base.number import Number, Vector
from flexstage.parts.body import Body
from flexstage.parts.leaf import Leaf
from flexstage.parts.shape import Elastic

FIRST, SECOND = "first", "second"
"""Bodies joined by the link, as named in members."""
_Z = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Member:
    """Member of a compound: its part, joined bodies (`first`, `second` or an inner body) and frame in the compound's, as for a link."""

    part: Elastic
    joins: tuple[str, str]
    at: Vector
    along: Vector
    bends: Vector = _Z


@dataclass(frozen=True, eq=False)
class Composition:
    """Composition of a compound: `members`, and inner `bodies` in its frame, massless unless specified."""

    members: Mapping[str, Member]
    bodies: Mapping[str, Body] = field(default_factory=dict)


class Compound(Elastic):
    """Compound part, replaced by its members at expansion: those of a link `B1/pivot` are named `B1/pivot.left`.

    Its numbers have addresses as in any part; they may be arrays and complex. Equal members should be one object, to compute their law
    once.
    """

    @property
    def is_axisymmetric(self) -> bool:
        """False: its members are on different sides of its axis."""
        return False

    @property
    def mirrored(self) -> Compound:
        """Itself: each member is mirrored individually."""
        return self

    @property
    def composition(self) -> Composition:
        """Members and inner bodies."""
        raise NotImplementedError


def radial_leaf(leaf: Leaf, joins: tuple[str, str], direction: tuple[Number, Number], *, centre: Number, height: Number = 0.0) -> Member:
    """Return a leaf along a `direction` (x, y) from the compound's z axis, with its middle at distance `centre` and z = `height`.

    It bends about z. The direction is of unit length.

    >>> radial_leaf(Leaf("steel", 0.02, 0.001, 0.01), ("first", "second"), (0.0, 1.0), centre=0.015).at
    (0.0, 0.015, 0.0)
    """
    x, y = direction
    return Member(leaf, joins, (centre * x, centre * y, height), (x, y, 0.0))
