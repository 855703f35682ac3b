"""Depth order: a binary space partition of facets, built once and read from any direction (Fuchs, Kedem and Naylor 1980)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import TypeAlias

import numpy as np

from flexstage.base.number import Array
from flexstage.show.scene.facet import Edge, Facet

_CANDIDATES = 8
_TOLERANCE = 1e-6
_Corner: TypeAlias = tuple[list[float], float, Edge]
"""Of a clipped facet: a point, its share and the edge that starts there (Sutherland and Hodgman)."""


@dataclass(frozen=True, eq=False)
class Partition:
    """A plane (normal (3,), offset), the facets in it, and what lies before and behind it."""

    normal: Array
    facets: tuple[Facet, ...]
    before: Partition | None
    behind: Partition | None


def partition(facets: Sequence[Facet], size: float) -> Partition | None:
    """Divide facets by their own planes, splitting those that cross one; `size` [m] is the scene's, for the tolerance.

    Faces of one convex solid stay together: of those that face a viewer none hides another.

    >>> partition((), 1.0) is None
    True
    """
    if not facets:
        return None
    if len(facets) == 1 or all(len(facet.points) < 3 for facet in facets) or _are_of_convex(facets, _TOLERANCE * size):
        return Partition(facets[0].normal, tuple(facets), None, None)
    normal, sides, distance = _best(facets, _TOLERANCE * size)
    here: list[Facet] = []
    before: list[Facet] = []
    behind: list[Facet] = []
    stop = 0
    for facet, side in zip(facets, sides, strict=True):
        start, stop = stop, stop + len(facet.points)
        if side == 0:
            here.append(facet)
        elif side == 2:
            first, second = split(facet, distance[start:stop])
            before.append(first)
            behind.append(second)
        else:
            (before if side == 1 else behind).append(facet)
    return Partition(normal, tuple(here), partition(before, size), partition(behind, size))


def _are_of_convex(facets: Sequence[Facet], tolerance: float) -> bool:
    """Whether facets are of one solid, all of it that is here behind the plane of each."""
    paint = facets[0].paint
    if not all(facet.paint is paint and len(facet.points) > 2 for facet in facets):
        return False
    normals = np.array([facet.normal for facet in facets])
    heights = np.concatenate([facet.points for facet in facets]) @ normals.T
    return bool(np.all(heights <= np.sum([facet.points[0] for facet in facets] * normals, axis=1) + tolerance))


def _best(facets: Sequence[Facet], tolerance: float) -> tuple[Array, list[int], Array]:
    """The candidate plane that splits least; the side of each facet (0 in the plane, 1 before, -1 behind, 2 split), all points' distances.

    Splits are dear, imbalance is cheap.
    """
    points = np.concatenate([facet.points for facet in facets])
    starts = [0, *accumulate(len(facet.points) for facet in facets[:-1])]
    flat = [index for index, facet in enumerate(facets) if len(facet.points) > 2]
    tried = flat[:: max(1, len(flat) // _CANDIDATES)][:_CANDIDATES]
    normals = np.array([facets[index].normal for index in tried])
    offsets = np.sum([facets[index].points[0] for index in tried] * normals, axis=1)
    distances = normals @ points.T - offsets[:, None]
    ahead = np.maximum.reduceat(distances, starts, axis=1) > tolerance
    back = np.minimum.reduceat(distances, starts, axis=1) < -tolerance
    first, second, both = (each.sum(axis=1) for each in (ahead, back, ahead & back))
    best = int(np.argmin(8 * both + np.abs(first - second)))
    sides = np.where(ahead[best] & back[best], 2, ahead[best].astype(int) - back[best])
    sides[tried[best]] = 0  # also where rounding says otherwise: every step takes at least one facet away
    return normals[best], sides.tolist(), distances[best]


def split(facet: Facet, distance: Array) -> tuple[Facet, Facet]:
    """The parts of a facet before and behind a plane at signed distances (n,) of its points; they know the whole.

    >>> from flexstage.show.scene.facet import Kind, Paint, line
    >>> halves = split(line(np.array([[-1.0, 0, 0], [1.0, 0, 0]]), Paint(Kind.BODY, ("a", "b"))), np.array([-1.0, 1.0]))
    >>> [half.points[:, 0].tolist() for half in halves]
    [[0.0, 1.0], [-1.0, 0.0]]
    """
    before: list[_Corner] = []
    behind: list[_Corner] = []
    corners = list(zip(facet.points.tolist(), facet.share.tolist(), facet.edges, distance.tolist(), strict=True))
    for (point, share, edge, here), (after, onward, _, there) in zip(corners, [*corners[1:], corners[0]], strict=True):
        part = here / (here - there) if here != there else 0.0
        for piece, inside, stays in ((before, here >= 0.0, there >= 0.0), (behind, here <= 0.0, there <= 0.0)):
            if inside:
                piece.append((point, share, edge))
            if inside != stays:
                cut = [first + part * (last - first) for first, last in zip(point, after, strict=True)]
                piece.append((cut, share + part * (onward - share), None if inside else edge))
    return _piece(facet, before), _piece(facet, behind)


def _piece(facet: Facet, corners: Sequence[_Corner]) -> Facet:
    """A part of a facet, whose cut is no edge."""
    kept = corners if len(facet.points) > 2 else corners[:2]
    points, share, edges = zip(*kept, strict=True)
    rest = edges if len(kept) > 2 else (edges[0], None)
    return Facet(np.array(points), rest, facet.paint, np.array(share), facet.whole or facet)


def sort_by_depth(tree: Partition | None, eye: Array) -> Iterator[Facet]:
    """Facets from the farthest to the nearest, seen from the direction `eye` (3,), towards the viewer; right among those that face it.

    >>> list(sort_by_depth(None, np.array([0.0, 0.0, 1.0])))
    []
    """
    stack: list[Partition | tuple[Facet, ...] | None] = [tree]
    while stack:
        item = stack.pop()
        if isinstance(item, Partition):
            near, far = (item.before, item.behind) if item.normal @ eye >= 0.0 else (item.behind, item.before)
            stack += [near, item.facets, far]
        elif item is not None:
            yield from item
