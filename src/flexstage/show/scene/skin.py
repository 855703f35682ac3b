"""Surfaces ("skins") for pictures and the viewer, from triangles and sharp edges, and functions that build simple surfaces."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from flexstage.base.number import Array
from flexstage.spatial.frame import Frame


class Kind(Enum):
    """Kind of a drawn part; a style gives each kind its colour."""

    PLATFORM = "platform"
    BODY = "body"
    HINGE = "hinge"
    DRIVE = "drive"
    GAUGE = "gauge"
    GROUND = "ground"


ROUND = slice(0)
"""Value of `along` in `loft` for a round section: no edge along the surface is sharp."""


@dataclass(frozen=True, eq=False)
class DrawnSurface:
    """A surface: `points` (n, 3) [m], `triangles` (t, 3) and sharp `edges` (e, 2) as indices of points.

    Corners of triangles are counter-clockwise as seen from outside. If the surface connects two bodies, point k moves by the weighted sum
    of the motions of the two bodies: 1 - `share`[k] is the weight of the first body, `share`[k] the weight of the second body.
    """

    points: Array
    triangles: Array
    edges: Array
    share: Array

    def placed(self, frame: Frame) -> DrawnSurface:
        """Return the surface transformed from a frame into its parent frame."""
        return replace(self, points=self.points @ frame.rotation.T + frame.position)


def join(skins: Sequence[DrawnSurface]) -> DrawnSurface:
    """Merge several surfaces into one.

    >>> bar = line(np.zeros((2, 3)))
    >>> join([bar, bar]).edges.tolist()
    [[0, 1], [2, 3]]
    """
    starts = np.cumsum([0, *(len(each.points) for each in skins)])
    return DrawnSurface(
        np.concatenate([np.zeros((0, 3)), *(each.points for each in skins)]),
        np.concatenate([np.zeros((0, 3), dtype=int), *(each.triangles + start for each, start in zip(skins, starts, strict=False))]),
        np.concatenate([np.zeros((0, 2), dtype=int), *(each.edges + start for each, start in zip(skins, starts, strict=False))]),
        np.concatenate([np.zeros(0), *(each.share for each in skins)]),
    )


def loft(
    rings: Array,
    *,
    ringed: Collection[int] = (0, -1),
    along: slice = slice(None),
    closed: bool = True,
    shares: Array | None = None,
) -> DrawnSurface:
    """Build the surface through rings (s, k, 3) of points, counter-clockwise seen from the last ring towards the first.

    If `closed`, the surface has end faces. `shares` (s,) are the weights of the second of two bodies that move the rings (see
    `DrawnSurface`), by default evenly spaced from 0 at the first ring to 1 at the last. The rings with indices `ringed` are sharp edges.
    The lines from ring to ring through the points that `along` selects are sharp edges too (`ROUND` selects no point).

    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    >>> box = loft(np.stack([square, square + [0, 0, 1.0]]))
    >>> len(box.triangles), len(box.edges)
    (12, 12)
    """
    count, sides = rings.shape[:2]
    here = np.arange(count * sides).reshape(count, sides)
    after = np.roll(here, -1, axis=1)
    triangles = [_rows(here[:-1], after[:-1], after[1:]), _rows(here[:-1], after[1:], here[1:])]
    edges = [_rows(here[list(ringed)], after[list(ringed)]), _rows(here[:-1][along], here[1:][along])]
    triangles += [fan(here[0, ::-1]), fan(here[-1])] if closed else []
    share = np.repeat(np.linspace(0.0, 1.0, count) if shares is None else shares, sides)
    return DrawnSurface(rings.reshape(-1, 3), np.concatenate(triangles), np.concatenate(edges), share)


def _rows(*columns: Array) -> Array:
    return np.stack([each.ravel() for each in columns], axis=1)


def fan(corners: Array) -> Array:
    """Divide a convex polygon with corner indices (k,) into triangles (k - 2, 3).

    >>> fan(np.array([4, 5, 6, 7])).tolist()
    [[4, 5, 6], [4, 6, 7]]
    """
    return np.column_stack([np.full(len(corners) - 2, corners[0]), corners[1:-1], corners[2:]])


def face(points: Array, share: float) -> DrawnSurface:
    """Build the surface of a convex polygon (k, 3). All points of the surface have the same `share` (see `DrawnSurface`).

    >>> len(face(np.zeros((5, 3)), 1.0).triangles)
    3
    """
    count = len(points)
    return DrawnSurface(points, fan(np.arange(count)), np.zeros((0, 2), dtype=int), np.full(count, share))


def pierce(outer: Array, inner: Array, *, along: slice = slice(0, None, 2)) -> DrawnSurface:
    """Build a prism with a through hole from `outer` and `inner` rings (2, k, 3): bottom, then top, with corresponding points.

    >>> square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0.0]])
    >>> both = np.stack([square, square + [0, 0, 1.0]])
    >>> len(pierce(2.0 * both, both).triangles)
    32
    """
    return loft(np.concatenate([outer, inner[::-1], outer[:1]]), ringed=range(4), along=along, closed=False)


def rectangle(height: float, width: float) -> Array:
    """Return the corners (4, 2) of a centred rectangle, counter-clockwise.

    >>> rectangle(2.0, 4.0).tolist()
    [[-1.0, -2.0], [1.0, -2.0], [1.0, 2.0], [-1.0, 2.0]]
    """
    return 0.5 * np.array([[-height, -width], [height, -width], [height, width], [-height, width]])


def circle(diameter: float, sides: int = 12) -> Array:
    """Return the corners (k, 2) of a regular polygon inscribed in a circle, counter-clockwise.

    >>> circle(2.0, 4).round(3).tolist()
    [[0.707, 0.707], [-0.707, 0.707], [-0.707, -0.707], [0.707, -0.707]]
    """
    angles = 2.0 * np.pi * (np.arange(sides) + 0.5) / sides
    return 0.5 * diameter * np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def extrude(stations: Array, sections: list[Array]) -> Array:
    """Build rings (s, k, 3) along x from a section (k, 2) in y and z at each station.

    >>> extrude(np.array([0.0, 1.0]), [rectangle(1.0, 1.0)] * 2).shape
    (2, 4, 3)
    """
    return np.stack(
        [np.column_stack([np.full(len(section), station), section]) for station, section in zip(stations, sections, strict=True)]
    )


def line(points: Array) -> DrawnSurface:
    """Build a line between two points (2, 3). The first point moves with the first body, the second point with the second body.

    >>> line(np.zeros((2, 3))).share.tolist()
    [0.0, 1.0]
    """
    return DrawnSurface(points, np.zeros((0, 3), dtype=int), np.array([[0, 1]]), np.array([0.0, 1.0]))
