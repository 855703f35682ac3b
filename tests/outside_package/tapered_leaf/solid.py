"""The tapered leaf as a CAD solid."""

from __future__ import annotations

from itertools import pairwise

from netgen import occ

from flexstage.solid.fea.geometry.piece import MILLIMETRES
from tapered_leaf.part import Taper


def taper_solid(part: Taper) -> occ.Solid:
    """Its outline in the xy plane, drawn through its width [mm]."""
    half, waist, end, width = (0.5 * MILLIMETRES * float(each) for each in (part.length, part.thickness, part.end_thickness, part.width))
    corners = [(-half, -end), (0.0, -waist), (half, -end), (half, end), (0.0, waist), (-half, end)]
    edges = [occ.Segment(occ.Pnt(*a, 0), occ.Pnt(*b, 0)) for a, b in pairwise([*corners, corners[0]])]
    return occ.Face(occ.Wire(edges)).Extrude(occ.Vec(0, 0, 2.0 * width)).Move(occ.Vec(0, 0, -width))
