"""Compound hinges: parts that are an assembly of others, which expansion puts in their place. They have no law and no shape of their own.

A new kind derives from `Compound` and says what it consists of; models, analyses, pictures and finite elements see its members only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from flexstage.base.number import Number, Vector
from flexstage.parts.body import Body
from flexstage.parts.leaf import Leaf
from flexstage.parts.shape import Elastic

FIRST, SECOND = "first", "second"
"""The bodies that the link joins, as members name them."""
_Z = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Member:
    """A part of a compound: what it `joins` (`first`, `second` or an inner body), its frame in the compound's, as a link states it."""

    part: Elastic
    joins: tuple[str, str]
    at: Vector
    along: Vector
    bends: Vector = _Z


@dataclass(frozen=True, eq=False)
class Composition:
    """What a compound consists of: its `members`, and inner `bodies`, drawn in its own frame; one that states no mass has none."""

    members: Mapping[str, Member]
    bodies: Mapping[str, Body] = field(default_factory=dict)


class Compound(Elastic):
    """A part whose links expansion replaces by its members: those of a link `B1/pivot` are called `B1/pivot.left`.

    Its numbers are addressed as those of any part; they may be arrays and complex. Members that are alike should be one object: their law
    is worked out once.
    """

    @property
    def is_axisymmetric(self) -> bool:
        """No: its members stand on different sides of its axis."""
        return False

    @property
    def mirrored(self) -> Compound:
        """Itself: each of its members is mirrored where it stands."""
        return self

    @property
    def composition(self) -> Composition:
        """Its members and inner bodies."""
        raise NotImplementedError


def radial_leaf(leaf: Leaf, joins: tuple[str, str], direction: tuple[Number, Number], *, centre: Number, height: Number = 0.0) -> Member:
    """A leaf along a `direction` (x, y) from the compound's z axis, its middle at the distance `centre` from it and at z = `height`.

    It bends about z. The direction is of unit length.

    >>> radial_leaf(Leaf("steel", 0.02, 0.001, 0.01), ("first", "second"), (0.0, 1.0), centre=0.015).at
    (0.0, 0.015, 0.0)
    """
    x, y = direction
    return Member(leaf, joins, (centre * x, centre * y, height), (x, y, 0.0))
