"""Facets: the flat convex polygons a picture is made of, and the primitives that are built of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from flexstage.base.number import Array


class Kind(Enum):
    """What a facet shows; a style gives each kind its colour."""

    PLATFORM = "platform"
    BODY = "body"
    HINGE = "hinge"
    DRIVE = "drive"
    GAUGE = "gauge"
    GROUND = "ground"


Edge: TypeAlias = Array | None
"""How the edge that starts at a point is drawn: never (None), or where the neighbouring facet, whose normal this is, faces away.

The zero vector stands for a sharp edge, which is always drawn.
"""

_NEXT, _LAST = [1, 2, 0], [2, 0, 1]
SHARP: Array = np.zeros(3)
SHARP.flags.writeable = False


@dataclass(frozen=True)
class Paint:
    """What the facets of one solid have in common: its kind, the bodies that carry it, its name (`B1/front`, `platform.plate`).

    A solid that is drawn as a piece of something else says of `what`.
    """

    kind: Kind
    carriers: tuple[str, str]
    name: str = ""
    what: str = ""

    @property
    def thing(self) -> str:
        """The name of what is shown."""
        return self.what or self.name


@dataclass(frozen=True, eq=False)
class Facet:
    """A convex polygon (or, with two points, a line) in the stage's frame; seen from outside its points run counter-clockwise.

    `points` (n, 3) [m]; `edges` one a point; `paint` says what it belongs to: point k follows the first of its carriers by 1 - `share`[k],
    the second by `share`[k]. A piece of a facet knows the `whole`.
    """

    points: Array
    edges: tuple[Edge, ...]
    paint: Paint
    share: Array
    whole: Facet | None = None

    @cached_property
    def normal(self) -> Array:
        """Outward unit normal (zero for a line and for a facet without area): Newell's sum of cross products."""
        if len(self.points) < 3:
            return SHARP
        first, *others = self.points.tolist()  # plain floats: facets have few points, and there are thousands
        arms = [(x - first[0], y - first[1], z - first[2]) for x, y, z in others]
        x, y, z = 0.0, 0.0, 0.0
        for (a, b, c), (d, e, f) in pairwise(arms):
            x, y, z = x + (b * f - c * e), y + (c * d - a * f), z + (a * e - b * d)
        total = np.array([x, y, z])
        size = math.sqrt(total @ total)
        return total / size if size > 0.0 else SHARP


def cross(first: Array, second: Array) -> Array:
    """Cross products of rows (..., 3); many times faster than numpy's for few rows.

    >>> cross(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])).tolist()
    [0.0, 0.0, 1.0]
    """
    return first[..., _NEXT] * second[..., _LAST] - first[..., _LAST] * second[..., _NEXT]


def loft(rings: Array, paint: Paint, *, round_section: bool = False, closed: bool = True, shares: Array | None = None) -> list[Facet]:
    """The skin through rings (s, k, 3) of points, counter-clockwise seen from the last ring towards the first; end faces where `closed`.

    The bodies' `shares` (s,) run from 0 at the first ring to 1 at the last, evenly if they are not said. With `round_section` edges along
    the skin show as outlines only.

    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    >>> len(loft(np.stack([square, square + [0, 0, 1.0]]), Paint(Kind.BODY, ("a", "a"))))
    6
    """
    count, sides = rings.shape[:2]
    share = np.linspace(0.0, 1.0, count) if shares is None else shares
    facets: list[Facet] = []
    after = np.roll(rings, -1, axis=1)
    for level in range(count - 1):
        quads = np.stack([rings[level], after[level], after[level + 1], rings[level + 1]], axis=1)
        normals = cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
        for side, quad in enumerate(quads):
            ends = (SHARP if level == 0 else None, SHARP if level == count - 2 else None)
            right, left = (normals[(side + step) % sides] if round_section else SHARP for step in (1, -1))
            facets.append(Facet(quad, (ends[0], right, ends[1], left), paint, share[[level, level, level + 1, level + 1]]))
    if closed:
        facets.append(Facet(rings[0, ::-1], (SHARP,) * sides, paint, np.zeros(sides)))
        facets.append(Facet(rings[-1], (SHARP,) * sides, paint, np.ones(sides)))
    return facets


def pierce(outer: Array, inner: Array, paint: Paint, *, round_section: bool = False) -> list[Facet]:
    """A prism with a through hole: `outer` and `inner` rings (2, k, 3), first the bottom, then the top, points facing one another.

    >>> square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0.0]])
    >>> both = np.stack([square, square + [0, 0, 1.0]])
    >>> len(pierce(2.0 * both, both, Paint(Kind.BODY, ("a", "a"))))
    16
    """
    facets = loft(outer, paint, round_section=round_section, closed=False)
    facets += loft(inner[:, ::-1], paint, round_section=round_section, closed=False)
    sides = outer.shape[1]
    for side in range(sides):
        after = (side + 1) % sides
        top = np.stack([outer[1, side], outer[1, after], inner[1, after], inner[1, side]])
        bottom = np.stack([outer[0, after], outer[0, side], inner[0, side], inner[0, after]])
        facets += [Facet(face, (SHARP, None, SHARP, None), paint, np.zeros(4)) for face in (top, bottom)]
    return facets


def rectangle(height: float, width: float) -> Array:
    """Corners (4, 2) of a centred rectangle, counter-clockwise.

    >>> rectangle(2.0, 4.0).tolist()
    [[-1.0, -2.0], [1.0, -2.0], [1.0, 2.0], [-1.0, 2.0]]
    """
    return 0.5 * np.array([[-height, -width], [height, -width], [height, width], [-height, width]])


def circle(diameter: float, sides: int = 12) -> Array:
    """Corners (k, 2) of a circle's polygon, counter-clockwise.

    >>> circle(2.0, 4).round(3).tolist()
    [[0.707, 0.707], [-0.707, 0.707], [-0.707, -0.707], [0.707, -0.707]]
    """
    angles = 2.0 * np.pi * (np.arange(sides) + 0.5) / sides
    return 0.5 * diameter * np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def extrude(stations: Array, sections: list[Array]) -> Array:
    """Rings (s, k, 3) along x: section (k, 2) in y and z at each station.

    >>> extrude(np.array([0.0, 1.0]), [rectangle(1.0, 1.0)] * 2).shape
    (2, 4, 3)
    """
    return np.stack(
        [np.column_stack([np.full(len(section), station), section]) for station, section in zip(stations, sections, strict=True)]
    )


def line(points: Array, paint: Paint) -> Facet:
    """A line between two points (2, 3), each following its body.

    >>> line(np.zeros((2, 3)), Paint(Kind.BODY, ("a", "b"))).share.tolist()
    [0.0, 1.0]
    """
    return Facet(points, (SHARP, None), paint, np.array([0.0, 1.0]))
