"""Depth order: a binary space partition of facets, built once and read from any direction (Fuchs, Kedem and Naylor 1980)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from flexstage.base.number import Array
from flexstage.show.scene.facet import Edge, Facet

_CANDIDATES = 8
_TOLERANCE = 1e-6


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
    return _clip(facet, distance), _clip(facet, -distance)


def _clip(facet: Facet, distance: Array) -> Facet:
    """Sutherland and Hodgman's clip to the side of positive distances; the cut is no edge."""
    points: list[Array] = []
    share: list[float] = []
    edges: list[Edge] = []
    count, reach = len(facet.points), distance.tolist()
    for index in range(count):
        after = (index + 1) % count
        inside, onward = reach[index] >= 0.0, reach[after] >= 0.0
        if inside:
            points.append(facet.points[index])
            share.append(facet.share[index])
            edges.append(facet.edges[index])
        if inside != onward:
            part = reach[index] / (reach[index] - reach[after])
            points.append(facet.points[index] + part * (facet.points[after] - facet.points[index]))
            share.append(facet.share[index] + part * (facet.share[after] - facet.share[index]))
            edges.append(None if inside else facet.edges[index])
    if count == 2:
        points, share, edges = points[:2], share[:2], [facet.edges[0], None]
    return Facet(np.array(points), tuple(edges), facet.paint, np.array(share), facet.whole or facet)


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
