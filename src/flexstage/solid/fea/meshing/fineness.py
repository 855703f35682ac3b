"""Options of a solid model: fineness and order of the mesh, and number of modes in each component. Loads no solver."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

from flexstage.base.arguments import CheckedFields

ATTEMPTS = ((1.0, 1.0, 1.0), (1.0, 0.7, 1.0), (0.8, 1.0, 1.0), (1.0, 1.0, 1.4), (0.85, 0.6, 1.0), (0.7, 0.7, 1.4), (0.5, 0.8, 1.0))
"""Variations of the mesh if the mesher fails: factors on all sizes, on the grading and on the segments per radius of curvature."""


NOTCH_MIDDLE, NOTCH_REACH = 0.7, 1.6
"""Element size in the middle plane of a notch over that on the faces of other hinges, and its extent on both sides, in geometric
means of radius and thickness. The strain gradient is largest there."""
WARPS = 12
"""Linear and quadratic motions of an interface face, without rigid ones."""


@dataclass(frozen=True)
class Fineness(CheckedFields):
    """Mesh size and polynomial `order`, also of the curved geometry; elements in notches have one order more.

    Elements are `neck` times a link's smallest thickness on its faces, `block` times a body's smallest dimension elsewhere, and grow by
    `grading` (0.1 slow to 0.9 fast).
    """

    neck: float = 1.5
    block: float = 1.5
    grading: float = 0.8
    order: int = 3


class Hold(Enum):
    """Motion of interface faces between elastic bodies: a twist and quadratic warps, or only the mean twist."""

    RIGID = "rigid"
    AVERAGED = "averaged"


@dataclass(frozen=True)
class Reduction(CheckedFields):
    """Options of a component's reduction: mesh and order, number of fixed-interface modes, constraint of its interface faces.

    `residual`: also keep the static response, faces fixed, to the inertia of the faces' motions. It replaces the omitted modes to first
    order in frequency squared. Components whose content is `raised` have elements of one order more than the others, and no
    modes if `static`: the static response does not need them.
    """

    fineness: Fineness = Fineness()
    modes: int = 12
    hold: Hold = Hold.RIGID
    residual: bool = False
    raised: frozenset[str] = frozenset()
    static: bool = False

    def of(self, content: str) -> Reduction:
        """The options of a component, by its content.

        >>> own = Reduction(raised=frozenset({"lever"}), static=True).of("lever")
        >>> own.fineness.order, own.modes
        (4, 0)
        """
        more = content in self.raised
        modes, finer = 0 if more and self.static else self.modes, replace(self.fineness, order=self.fineness.order + more)
        return replace(self, fineness=finer, modes=modes, raised=frozenset(), static=False)
