"""Profiles of flexure hinges: how the cross-section's thickness grows along the hinge.

A profile gives the half length a of the hinge and the added height w(s) >= 0 on each side at the station s in [-1, 1], x = a s. The
section's thickness there is t + 2 w. Stations let the quadrature concentrate where the section is thin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, TypeAlias

import numpy as np

from flexstage.base.digest import Description
from flexstage.base.number import Array, Number
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


_ARC = np.deg2rad([0.0, 45.0, 90.0])

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


def rise(profile: Profile) -> Number:
    """How far the profile's cuts rise above the neck at its ends, w(+-1) [m].

    >>> rise(Circular(0.005))
    0.005
    """
    if isinstance(profile, Circular):
        return profile.radius
    if isinstance(profile, Elliptic):
        return profile.across
    return profile.radius if isinstance(profile, Filleted) else 0.0


def closing(profile: Profile, thickness: Number) -> float:
    """The angle [rad] at which the faces of a cut touch: it is as wide as the hinge is long, and as deep as the profile rises.

    >>> round(closing(Circular(0.005), 0.0) / np.pi, 9), closing(Straight(0.005), 0.001)
    (0.5, inf)
    """
    if isinstance(profile, Straight):
        return np.inf
    return 2.0 * float(np.arctan2(0.5 * single(length(profile)), single(rise(profile)) + 0.5 * single(thickness)))


def stations_of(profile: Profile) -> tuple[Array, Array]:
    """Stations x (s,) from end to end and the height w (s,) a profile adds on each side [m], of the first design.

    >>> stations, heights = stations_of(Circular(0.005))
    >>> float(stations[0]), heights.round(6).tolist()
    (-0.005, [0.005, 0.001464, 0.0, 0.001464, 0.005])
    """
    half = 0.5 * single(length(profile))
    if isinstance(profile, (Circular, Elliptic)):
        across = single(rise(profile))
        stations, heights = half * np.sin(_ARC), across * (1.0 - np.cos(_ARC))
    elif isinstance(profile, Filleted):
        radius = single(profile.radius)
        stations, heights = half - radius + radius * np.sin(_ARC), radius * (1.0 - np.cos(_ARC))
    else:
        stations, heights = np.array([half]), np.array([0.0])
    keep = stations > 0.0
    middle = ([0.0], [0.0]) if isinstance(profile, (Circular, Elliptic)) else ([], [])
    return (
        np.concatenate([-stations[keep][::-1], middle[0], stations[keep]]),
        np.concatenate([heights[keep][::-1], middle[1], heights[keep]]),
    )


def single(value: Number) -> float:
    """A number of the first design.

    >>> single(np.array([1.0, 2.0]))
    1.0
    """
    return float(np.real(np.ravel(value)[0]))
