"""Silhouettes: the convex outline of what is seen from one direction, for plans and for stages of very many parts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.base.number import Array
from flexstage.show.scene.facet import SHARP, Facet


def silhouettes(facets: Sequence[Facet], axes: Array) -> list[Facet]:
    """Each solid as one facet, its convex outline as seen along the last of the `axes` (3, 3), and all lines; from the farthest by middles.

    Of thousands of parts that is a hundredth of the work of ordering their facets, and right wherever they are small beside the stage. What
    is long or hollow may stand before what it ought to stand behind.

    >>> from flexstage.show.scene.facet import Kind, Paint, loft
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    >>> block = loft(np.stack([square, square + [0, 0, 1.0]]), Paint(Kind.BODY, ("a", "a")))
    >>> [each.points.tolist() for each in silhouettes(block, np.eye(3))]
    [[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]]]
    """
    solids: dict[int, list[Facet]] = {}
    for facet in facets:
        solids.setdefault(id(facet.paint) if len(facet.points) > 2 else id(facet), []).append(facet)
    outlines = [_outline(each, axes) for each in solids.values()]
    depths = [float(facet.points.mean(axis=0) @ axes[2]) for facet in outlines]
    return [outlines[place] for place in np.argsort(depths, kind="stable")]


def _outline(facets: Sequence[Facet], axes: Array) -> Facet:
    """The outline of a solid, of its points that lie farthest towards the viewer."""
    if len(facets[0].points) == 2:
        return facets[0]
    points, share = np.concatenate([facet.points for facet in facets]), np.concatenate([facet.share for facet in facets])
    nearest = np.argsort(points @ axes[2], kind="stable")
    places = nearest[_corners(1e3 * points[nearest] @ axes[:2].T)]
    return Facet(points[places], (SHARP,) * len(places), facets[0].paint, share[places])


def hull(points: Array) -> Array:
    """Convex outline (k, 2) of points (n, 2), counter-clockwise.

    >>> hull(np.array([[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]])).tolist()
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    """
    return np.round(points[_corners(points)], 6)


def _corners(points: Array) -> list[int]:
    """Places of the corners of the convex outline, of equal ones the last (Andrew's monotone chain)."""
    places = {(x, y): place for place, (x, y) in enumerate(np.round(points, 6).tolist())}
    ordered = sorted(places)
    if len(ordered) < 3:
        return [places[each] for each in ordered]
    return [places[each] for each in _chain(ordered)[:-1] + _chain(ordered[::-1])[:-1]]


def _chain(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points in their order, without those at which the way from the one before to the one after does not turn left."""
    chain: list[tuple[float, float]] = []
    for x, y in points:
        while len(chain) > 1:
            (x0, y0), (x1, y1) = chain[-2:]
            if (x1 - x0) * (y - y0) > (y1 - y0) * (x - x0):
                break
            chain.pop()
        chain.append((x, y))
    return chain
