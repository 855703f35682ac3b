"""Which facets of a picture are hidden: they need not be drawn, and a picture without them is a third of the size."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.base.number import Array

_PIXELS = 450


def visible(polygons: Sequence[Array], opaque: Sequence[bool]) -> list[bool]:
    """Whether each convex polygon (n, 2), given from the farthest to the nearest, shows from under the opaque ones before it.

    Decided on a raster; lines, and polygons too small to hold a point of it, count as visible.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> visible([square, square], [True, True])
    [False, True]
    """
    if not polygons:
        return []
    everything = np.concatenate(polygons)
    low = everything.min(axis=0)
    extent = float((everything.max(axis=0) - low).max()) or 1.0
    covered = np.zeros((_PIXELS + 1, _PIXELS + 1), dtype=bool)
    result = [True] * len(polygons)
    for index in reversed(range(len(polygons))):
        if len(polygons[index]) < 3:
            continue
        corner, inside = _raster((polygons[index] - low) * (_PIXELS / extent))
        rows, columns = inside.shape
        window = covered[corner[1] : corner[1] + rows, corner[0] : corner[0] + columns]
        if inside.any():
            result[index] = bool(np.any(inside & ~window))
            if opaque[index]:
                window |= inside
    return result


def _raster(polygon: Array) -> tuple[tuple[int, int], Array]:
    """First column and row of the polygon's box, and which raster points (rows, columns) of it lie inside."""
    first = np.maximum(np.ceil(polygon.min(axis=0)).astype(int), 0)
    last = np.minimum(np.floor(polygon.max(axis=0)).astype(int), _PIXELS)
    x = np.arange(first[0], last[0] + 1)[None, :]
    y = np.arange(first[1], last[1] + 1)[:, None]
    inside = np.ones((max(0, len(y)), max(0, x.shape[1])), dtype=bool)
    after = np.roll(polygon, -1, axis=0)
    turn = np.sum(polygon[:, 0] * after[:, 1] - polygon[:, 1] * after[:, 0])
    for start, end in zip(polygon, after, strict=True):
        side = (end[0] - start[0]) * (y - start[1]) - (end[1] - start[1]) * (x - start[0])
        inside &= side * turn >= 0.0
    return (int(first[0]), int(first[1])), inside
