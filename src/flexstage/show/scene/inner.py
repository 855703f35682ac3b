"""Inner faces: what the outlines of one body hide from one another where they touch."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from flexstage.base.number import Array
from flexstage.show.scene.facet import Facet, cross
from flexstage.show.scene.order import split

_FLUSH = 1e-6
"""Faces touch, and pieces are worth drawing, from this distance on [m]."""


def outer(facets: Sequence[Facet]) -> list[Facet]:
    """The facets of one body without what lies on faces of its other outlines that look at them: seen through, it would look like a cut.

    >>> from flexstage.show.scene.facet import Kind, Paint, loft
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    >>> low = loft(np.stack([square, square + [0, 0, 1.0]]), Paint(Kind.PLATFORM, ("a", "a"), "low"))
    >>> high = loft(np.stack([square + [0, 0, 1.0], square + [0, 0, 2.0]]), Paint(Kind.PLATFORM, ("a", "a"), "high"))
    >>> len(low + high), len(outer(low + high))
    (12, 10)
    """
    covers: list[list[Array]] = [[] for _ in facets]
    sides = cache(lambda index: _sides(facets[index]))
    for one, other in np.argwhere(_are_back_to_back(facets)).tolist():
        if facets[one].paint.name != facets[other].paint.name:
            covers[one].append(sides(other))
    return [piece for facet, own in zip(facets, covers, strict=True) for piece in _subtract(facet, own)]


def _are_back_to_back(facets: Sequence[Facet]) -> Array:
    """Which facets (n, n) lie in one plane and look opposite ways."""
    normals = np.array([facet.normal for facet in facets]).reshape(-1, 3)
    offsets = np.array([facet.points[0] @ facet.normal for facet in facets])
    return (normals @ normals.T < -1.0 + 1e-9) & (np.abs(offsets[:, None] + offsets) < _FLUSH)


def _subtract(facet: Facet, covers: Sequence[Array]) -> Iterator[Facet]:
    """What is left of a facet, in convex pieces, where the `_sides` of covers are these."""
    if not covers:
        yield facet
        return
    rest, pieces = facet, list[Facet]()
    starts, outward = covers[0]
    if np.any(np.min(facet.points @ outward.T - np.sum(starts * outward, axis=1), axis=0) > -_FLUSH):
        yield from _subtract(facet, covers[1:])
        return
    for start, out in zip(starts, outward, strict=True):
        distance = (rest.points - start) @ out
        if np.all(distance < _FLUSH):
            continue
        if np.all(distance > -_FLUSH):
            yield from _subtract(facet, covers[1:])
            return
        beyond, rest = (replace(piece, whole=None) for piece in split(rest, distance))
        pieces.append(beyond)
    for piece in pieces:
        yield from _subtract(piece, covers[1:])


def _sides(cover: Facet) -> Array:
    """A point of each side of a facet, and the unit direction out of it in its plane (2, k, 3)."""
    outward = cross(np.roll(cover.points, -1, axis=0) - cover.points, cover.normal)
    return np.stack([cover.points, outward / np.sqrt(np.sum(outward**2, axis=1, keepdims=True))])
