"""Which facets of a picture are hidden: they need not be drawn, and a picture without them is a third of the size."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING

import numpy as np

from flexstage.base.lazy import Late
from flexstage.base.number import Array

if TYPE_CHECKING:
    from PIL import Image, ImageDraw
else:
    Image, ImageDraw = Late("PIL.Image"), Late("PIL.ImageDraw")  # only pictures need them

_PIXELS = 800


def are_visible(polygons: Sequence[Array], opaque: Sequence[bool]) -> list[bool]:
    """Whether each convex polygon (n, 2), given from the farthest to the nearest, shows from under the opaque ones before it.

    Decided on a raster, to a point of it; lines, and polygons smaller than two points of it, count as visible.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> are_visible([square, square], [True, True])
    [False, True]
    """
    if not polygons:
        return []
    everything = np.concatenate(polygons)
    low = everything.min(axis=0)
    places = (everything - low) * ((_PIXELS - 1) / (float((everything - low).max()) or 1.0))
    starts = [0, *accumulate(len(each) for each in polygons)]
    drawn = [places[start:end] for start, end in pairwise(starts)]
    nearest = Image.new("I", tuple(np.ceil(places.max(axis=0)).astype(int) + 1), 0)
    pen = ImageDraw.Draw(nearest)
    for number, polygon in enumerate(drawn, 1):
        if opaque[number - 1] and len(polygon) > 2:
            pen.polygon(polygon.ravel().tolist(), fill=number)
    last = np.asarray(nearest)
    shows = np.zeros(len(polygons) + 1, dtype=bool)
    shows[last[:, 0]] = True
    shows[last[:, 1:][last[:, 1:] != last[:, :-1]]] = True  # where a row's colour changes: many times fewer than all points
    small = np.all(np.maximum.reduceat(places, starts[:-1]) - np.minimum.reduceat(places, starts[:-1]) < 2.0, axis=1)
    always = (shows[1:] | small | (np.diff(starts) < 3)).tolist()
    return [always[index] or (not opaque[index] and _is_before(polygon, last, index)) for index, polygon in enumerate(drawn)]


def _is_before(polygon: Array, last: Array, count: int) -> bool:
    """Whether some point of the raster that the polygon covers shows one of the first `count` facets, or none: it lies before that."""
    left, top = np.floor(polygon.min(axis=0)).astype(int)
    right, bottom = np.ceil(polygon.max(axis=0)).astype(int) + 1
    behind = last[top:bottom, left:right] <= count
    if behind.all() or not behind.any():
        return bool(behind.all())
    mask = Image.new("1", (right - left, bottom - top))
    ImageDraw.Draw(mask).polygon((polygon - (left, top)).ravel().tolist(), fill=1)
    return bool(np.any(behind & np.asarray(mask)[: behind.shape[0], : behind.shape[1]]))
