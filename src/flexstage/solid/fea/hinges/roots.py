"""Roots: ends of a hinge on an elastic block that deforms near the hinge, in contrast to ends on rigid bodies."""

from __future__ import annotations

from dataclasses import dataclass

from flexstage.mechanism.assembly.expand import Assembly, PlacedLink
from flexstage.parts.shape import Profiled, Shaped
from flexstage.solid.fea.solver.component import is_elastic

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Roots:
    """Whether the `first` end of a hinge (at -x of its frame) and the `second` end are on elastic blocks; other ends are rigid."""

    first: bool
    second: bool

    @property
    def mirrored(self) -> Roots:
        """The roots after an exchange of the hinge's two ends.

        >>> Roots(True, False).mirrored
        Roots(first=False, second=True)
        """
        return Roots(self.second, self.first)


def own_roots(part: Shaped) -> Roots:
    """Return the roots of an isolated hinge. If its profile `rises`, both ends are on blocks; otherwise both ends are on rigid faces.

    >>> from flexstage.parts.leaf import Leaf
    >>> own_roots(Leaf("steel", length=0.01, thickness=1e-3, width=5e-3))
    Roots(first=False, second=False)
    """
    return Roots(rises(part), rises(part))


def rises(part: Shaped) -> bool:
    """Return whether the cuts of a profile end at the full height of the part.

    >>> from flexstage.parts.leaf import Leaf
    >>> rises(Leaf("steel", length=0.01, thickness=1e-3, width=5e-3))
    False
    """
    highest = max(section.height for _, section in part.silhouette) * (1.0 - _ROUNDING)
    return isinstance(part, Profiled) and bool(part.end.first.height >= highest > part.throat.first.height)


def roots_of(assembly: Assembly, link: PlacedLink) -> Roots:
    """Return the roots of a link in the stage: the ends on bodies with outlines. The ground and bodies without outlines are rigid.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> assembly = expand(double_triangle())
    >>> roots_of(assembly, assembly.links["B1/back"])
    Roots(first=False, second=True)
    """
    first, second = (is_elastic(assembly, body) for body in link.joins)
    return Roots(first, second)
