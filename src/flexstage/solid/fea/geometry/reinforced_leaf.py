"""The leaf with a thick middle as a CAD solid."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from netgen import occ

from flexstage.parts.profile import single
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.solid.fea.geometry.contour import arc, extrude_outline, segments
from flexstage.solid.fea.geometry.piece import MILLIMETRES, millimetres


def reinforced_solid(part: ReinforcedLeaf) -> occ.Solid:
    """Draw a reinforced leaf [mm]: an outline in the xy plane is extruded over the leaf's width.

    >>> leaf = ReinforcedLeaf("steel", 0.04, 0.5e-3, 0.02, flexure_length=0.01, reinforced_thickness=3e-3)
    >>> round(reinforced_solid(leaf).mass, 6)
    1400.0
    """
    edges = [edge for line in _outline(part) for edge in ([arc(line)] if len(line) == 3 else segments(line))]
    return extrude_outline(edges, millimetres(part.width))


def _outline(part: ReinforcedLeaf) -> Iterator[list[tuple[float, float]]]:
    """Lines of two points and arcs of three points, counter-clockwise about the origin, quarter by quarter."""
    half, start = (MILLIMETRES * (0.5 * single(part.length) - away) for away in (0.0, single(part.flexure_length)))
    thin, thick = 0.5 * millimetres(part.thickness), 0.5 * millimetres(part.reinforced_thickness)
    radius = 0.0 if part.fillet is None else millimetres(part.fillet)
    off = radius * (1.0 - np.sqrt(0.5))
    rounded = [[(start + radius, thin), (start + off, thin + off), (start, thin + radius)]] if radius > 0.0 else []
    step = [[(start, thin + radius), (start, thick)], [(start, thick), (0.0, thick)]]
    quarter = [[(half, thin), (start + radius, thin)], *rounded, *step]
    for right, up in ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)):
        lines = [[(right * x, up * y) for x, y in line] for line in quarter]
        if right == up:
            yield from lines
        else:
            yield from (line[::-1] for line in reversed(lines))
            yield [(right * half, up * thin), (right * half, -up * thin)]
