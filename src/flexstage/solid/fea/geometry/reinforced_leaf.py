"""The leaf with a thick middle as a CAD solid."""

from __future__ import annotations

import numpy as np
from netgen import occ

from flexstage.parts.profile import single
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.solid.fea.geometry.contour import segments
from flexstage.solid.fea.geometry.piece import MILLIMETRES


def reinforced_solid(part: ReinforcedLeaf) -> occ.Solid:
    """Draw a reinforced leaf [mm]: an outline in the xy plane is extruded over the leaf's width.

    >>> leaf = ReinforcedLeaf("steel", 0.04, 0.5e-3, 0.02, flexure_length=0.01, reinforced_thickness=3e-3)
    >>> round(reinforced_solid(leaf).mass, 6)
    1400.0
    """
    quarters = [_quarter(part, *sides) for sides in ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0))]
    half, thin = 0.5 * MILLIMETRES * single(part.length), 0.5 * MILLIMETRES * single(part.thickness)
    ends = [segments([(-half, thin), (-half, -thin)]), segments([(half, -thin), (half, thin)])]
    edges = [*quarters[0], *quarters[1], *ends[0], *quarters[2], *quarters[3], *ends[1]]
    depth = MILLIMETRES * single(part.width)
    return occ.Face(occ.Wire(edges)).Extrude(occ.Vec(0, 0, depth)).Move(occ.Vec(0, 0, -0.5 * depth))


def _quarter(part: ReinforcedLeaf, right: float, up: float) -> list[occ.TopoDS_Shape]:
    """The edge in one quarter of the plane, counter-clockwise about the origin."""
    half, start = (MILLIMETRES * (0.5 * single(part.length) - away) for away in (0.0, single(part.flexure_length)))
    thin, thick = 0.5 * MILLIMETRES * single(part.thickness), 0.5 * MILLIMETRES * single(part.reinforced_thickness)
    radius = 0.0 if part.fillet is None else MILLIMETRES * single(part.fillet)

    def at(x: float, y: float) -> tuple[float, float]:
        return right * x, up * y

    forwards = right * up > 0.0
    lower, upper = [at(half, thin), at(start + radius, thin)], [at(start, thin + radius), at(start, thick), at(0.0, thick)]
    arc = []
    if radius > 0.0:
        middle = at(start + radius * (1.0 - np.sqrt(0.5)), thin + radius * (1.0 - np.sqrt(0.5)))
        points = [occ.Pnt(*point, 0) for point in (lower[1], middle, upper[0])]
        arc = [occ.ArcOfCircle(*(points if forwards else points[::-1]))]
    if forwards:
        return [*segments(lower), *arc, *segments(upper)]
    return [*segments(upper[::-1]), *arc, *segments(lower[::-1])]
