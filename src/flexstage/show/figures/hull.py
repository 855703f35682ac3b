"""The convex outline of points in a plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.base.number import Array


def hull(points: Array) -> Array:
    """Return the convex outline (k, 2) of points (n, 2), counter-clockwise (Andrew's monotone chain).

    >>> hull(np.array([[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]])).tolist()
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    """
    ordered = np.unique(np.round(points, 6), axis=0).tolist()
    return np.array(ordered if len(ordered) < 3 else _chain(ordered)[:-1] + _chain(ordered[::-1])[:-1])


def _chain(points: Sequence[Sequence[float]]) -> list[Sequence[float]]:
    """The points in their order, without those at which the way from the one before to the one after does not turn left."""
    chain: list[Sequence[float]] = []
    for x, y in points:
        while len(chain) > 1:
            (x0, y0), (x1, y1) = chain[-2:]
            if (x1 - x0) * (y - y0) > (y1 - y0) * (x - x0):
                break
            chain.pop()
        chain.append((x, y))
    return chain
