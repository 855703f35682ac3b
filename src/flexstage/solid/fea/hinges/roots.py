"""Roots: where a hinge grows out of an elastic block, which yields there, and where it ends on something rigid."""

from __future__ import annotations

from dataclasses import dataclass

from flexstage.mechanism.assembly.expand import Assembly, PlacedLink
from flexstage.parts.shape import Profiled, Shaped
from flexstage.solid.fea.solver.component import is_elastic

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Roots:
    """Whether a hinge's `first` end (towards -x of its frame) and its `second` grow on an elastic block; else an end is held rigid."""

    first: bool
    second: bool

    @property
    def mirrored(self) -> Roots:
        """The roots of the hinge turned end for end.

        >>> Roots(True, False).mirrored
        Roots(first=False, second=True)
        """
        return Roots(self.second, self.first)


def own_roots(part: Shaped) -> Roots:
    """The roots of a hinge by itself: profiles that rise grow on the blocks they rise to, all others stand between rigid faces.

    >>> from flexstage.parts.leaf import Leaf
    >>> own_roots(Leaf("steel", length=0.01, thickness=1e-3, width=5e-3))
    Roots(first=False, second=False)
    """
    return Roots(rises(part), rises(part))


def rises(part: Shaped) -> bool:
    """Whether a profile of cuts rises to the full height of the blocks that a hinge grows on.

    >>> from flexstage.parts.leaf import Leaf
    >>> rises(Leaf("steel", length=0.01, thickness=1e-3, width=5e-3))
    False
    """
    highest = max(section.height for _, section in part.silhouette) * (1.0 - _ROUNDING)
    return isinstance(part, Profiled) and bool(part.end.first.height >= highest > part.throat.first.height)


def roots_of(assembly: Assembly, link: PlacedLink) -> Roots:
    """The roots a link has where it is: on bodies with outlines; the ground and bodies without outlines are rigid.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> assembly = expand(double_triangle())
    >>> roots_of(assembly, assembly.links["B1/back"])
    Roots(first=False, second=True)
    """
    first, second = (is_elastic(assembly, body) for body in link.joins)
    return Roots(first, second)
