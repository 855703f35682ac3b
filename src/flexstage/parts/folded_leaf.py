"""Folded leaves: two leaves in series at a right angle."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.parts.body import Block, Body
from flexstage.parts.compound import FIRST, SECOND, Composition, Compound, radial_leaf
from flexstage.parts.freedom import Freedom, others
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.shape import INNER_MODES, Order


@dataclass(frozen=True, eq=False)
class FoldedLeaf(Compound):
    """Folded leaf with a right angle: it constrains only the translation along its fold, z.

    The link's origin is the fold. The first leaf, of `length`, extends along x from the first body to the fold. The second leaf, of
    `second_length` (default: equal), extends along y to the second body. `corner` is the side length of a solid square at the fold; the two
    lengths do not include the square. Without a `corner`, the fold is rigid and massless.
    """

    kind: ClassVar[str] = "folded_leaf"
    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]
    second_length: Annotated[Number, LENGTH, POSITIVE] | None = None
    corner: Annotated[Number, LENGTH, POSITIVE] | None = None
    section: LeafSection = LeafSection.PLATE
    inner_modes: Annotated[int, INNER_MODES] = 0

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom: all except the translation along the fold."""
        return others((Freedom.Z,))

    @property
    def composition(self) -> Composition:
        """Leaves `inner`, from the first body to the body `fold`, and `outer`, from `fold` to the second body."""
        first = Leaf(self.material, self.length, self.thickness, self.width, self.section, self.inner_modes)
        second = first if self.second_length is None else replace(first, length=self.second_length)
        half = 0.0 if self.corner is None else 0.5 * self.corner
        inner = radial_leaf(first, (FIRST, "fold"), (1.0, 0.0), centre=-half - 0.5 * first.length)
        outer = radial_leaf(second, ("fold", SECOND), (0.0, 1.0), centre=half + 0.5 * second.length)
        return Composition({"inner": inner, "outer": outer}, {"fold": self._fold})

    @property
    def _fold(self) -> Body:
        solids = {} if self.corner is None else {"corner": Block(self.material, (self.corner, self.corner, self.width))}
        return Body(solids, reference=(0.0, 0.0, 0.0))

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the leaves are thinner than wide, and not thicker than the corner."""
        yield Order("thickness", self.thickness, self.width, "the width", "Exchange both values, or rotate the link's bends")
        yield Order("thickness", self.thickness, self.corner, "the corner", "Make the corner larger", strict=False)
