"""Profiles of flexure hinges: how the cross-section's thickness grows along the hinge.

A profile gives the half length a of the hinge and the added height w(s) >= 0 on each side at the station s in [-1, 1], x = a s. The
section's thickness there is t + 2 w. Stations let the quadrature concentrate where the section is thin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, TypeAlias

from flexstage.base.digest import Description
from flexstage.base.number import Number
from flexstage.base.quantity import LENGTH, POSITIVE


@dataclass(frozen=True, eq=False)
class Circular(Description):
    """Two half-circle cuts of one radius: x = R sin p, w = R (1 - cos p), p in [-90, 90] degrees."""

    radius: Annotated[Number, LENGTH, POSITIVE]


@dataclass(frozen=True, eq=False)
class Elliptic(Description):
    """Two half-ellipse cuts: x = a sin p, w = c (1 - cos p); `along` = a on the hinge axis, `across` = c; c -> 0 is a leaf."""

    along: Annotated[Number, LENGTH, POSITIVE]
    across: Annotated[Number, LENGTH, POSITIVE]


@dataclass(frozen=True, eq=False)
class Filleted(Description):
    """A straight middle with quarter-circle fillets at both ends: total `length` l, fillet `radius` r, 2 r <= l."""

    length: Annotated[Number, LENGTH, POSITIVE]
    radius: Annotated[Number, LENGTH, POSITIVE]


@dataclass(frozen=True, eq=False)
class Straight(Description):
    """A prismatic hinge of constant section: `length` l."""

    length: Annotated[Number, LENGTH, POSITIVE]


Profile: TypeAlias = Circular | Elliptic | Filleted | Straight


def length(profile: Profile) -> Number:
    """Total length of the hinge between the ends of its arcs [m].

    >>> length(Circular(0.005)), length(Straight(0.013))
    (0.01, 0.013)
    """
    if isinstance(profile, Circular):
        return 2.0 * profile.radius
    if isinstance(profile, Elliptic):
        return 2.0 * profile.along
    return profile.length
