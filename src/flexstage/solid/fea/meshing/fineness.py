"""What is asked of a solid model: how fine a mesh, of which order, and how many modes within each component. Loads no solver."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

from flexstage.base.arguments import CheckedFields

ATTEMPTS = ((1.0, 1.0, 1.0), (1.0, 0.7, 1.0), (0.8, 1.0, 1.0), (1.0, 1.0, 1.4), (0.85, 0.6, 1.0), (0.7, 0.7, 1.4), (0.5, 0.8, 1.0))
"""How the mesh is varied where the mesher fails: factors on all sizes, on the grading and on the segments per radius of curvature."""


NOTCH_MIDDLE, NOTCH_REACH = 0.7, 1.6
"""Elements in the middle plane of a notch are this share of those on the faces of other hinges, so far along it on both sides, in geometric
means of radius and thickness: there strain changes most."""
WARPS = 12
"""Motions of an interface face that are linear or quadratic over it, and not rigid."""


@dataclass(frozen=True)
class Fineness(CheckedFields):
    """How fine to mesh and of which polynomial `order`, that of the curved geometry included; notches take one order more within.

    Elements are `neck` times a link's least thickness on its faces, `block` times a body's least dimension elsewhere, and grow by
    `grading` (0.1 slow to 0.9 fast).
    """

    neck: float = 1.5
    block: float = 1.5
    grading: float = 0.8
    order: int = 3


class Hold(Enum):
    """How interface faces between elastic bodies follow: held to a twist and quadratic warps, or by their mean twist only."""

    RIGID = "rigid"
    AVERAGED = "averaged"


@dataclass(frozen=True)
class Reduction(CheckedFields):
    """How a component is reduced: mesh and order, how many fixed-interface modes it keeps, how its interface faces are held.

    `residual`: it also keeps the static response, faces held, to the inertia of the faces' motions: what is left of the modes that are not
    kept, to first order in frequency squared. Components whose content is `raised` get elements of one order more than the others, and no
    modes where they are `static`: the response to loads at rest does not need them.
    """

    fineness: Fineness = Fineness()
    modes: int = 12
    hold: Hold = Hold.RIGID
    residual: bool = False
    raised: frozenset[str] = frozenset()
    static: bool = False

    def of(self, content: str) -> Reduction:
        """What it asks of a component, by its content.

        >>> own = Reduction(raised=frozenset({"lever"}), static=True).of("lever")
        >>> own.fineness.order, own.modes
        (4, 0)
        """
        more = content in self.raised
        modes, finer = 0 if more and self.static else self.modes, replace(self.fineness, order=self.fineness.order + more)
        return replace(self, fineness=finer, modes=modes, raised=frozenset(), static=False)
