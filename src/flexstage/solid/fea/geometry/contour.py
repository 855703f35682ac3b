"""The edge of a hinge from its height profile, as CAD curves in millimetres."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from netgen import occ

from flexstage.base.number import Array
from flexstage.parts.profile import Contour
from flexstage.solid.fea.geometry.piece import MILLIMETRES

_STATIONS = 65
_SAME = 1e-9
"""Largest distance [mm] between a drawn curve and the contour that the curve replaces."""


def contour_edges(contour: Contour, rise: float, sign: float) -> list[occ.TopoDS_Shape]:
    """Draw the edge y = sign (rise + w(x)) [mm] of a contour with the height w(x), from end to end.

    The edge has a vertex in the middle, where the mesh must be fine. Straight and cubic intervals are drawn exactly. Any other interval is
    a spline through 65 points, with an error of at most 2e-5 of its size.

    >>> from flexstage.parts.profile import Vee
    >>> [round(edge.mass, 6) for edge in contour_edges(Vee(2e-3, 1e-4, np.pi / 2.0), 0.5, 1.0)[::3]]  # two flanks at 45 degrees
    [1.314214, 1.314214]
    """
    pieces = list(pairwise(contour.knots))
    left = [_curve(contour, -end, -start, rise, sign) for start, end in reversed(pieces)]
    return [*left, *(_curve(contour, start, end, rise, sign) for start, end in pieces)]


def _curve(contour: Contour, start: float, end: float, rise: float, sign: float) -> occ.TopoDS_Shape:
    """One smooth piece between two stations [m]."""
    share = np.linspace(0.0, 1.0, 4)
    corners = rise + MILLIMETRES * contour.height(start + (end - start) * share)
    dense = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, _STATIONS))
    heights = rise + MILLIMETRES * contour.height(start + (end - start) * dense)
    cubic = np.polynomial.polynomial.polyfit(share, corners, 3)
    if np.max(np.abs(np.polynomial.polynomial.polyval(dense, cubic) - heights)) > _SAME:
        return occ.SplineInterpolation(_points(start, end, dense, sign * heights))
    if max(abs(cubic[2]), abs(cubic[3])) < _SAME:
        return occ.Segment(*_points(start, end, share[::3], sign * corners[::3]))
    return occ.BezierCurve(_points(start, end, share, sign * _controls(corners)))


def _controls(heights: Array) -> Array:
    """Heights of the control points of the cubic Bezier curve through four heights at equal distances."""
    first, second, third, last = heights
    inner = (-5.0 * first + 18.0 * second - 9.0 * third + 2.0 * last, 2.0 * first - 9.0 * second + 18.0 * third - 5.0 * last)
    return np.array([first, inner[0] / 6.0, inner[1] / 6.0, last])


def _points(start: float, end: float, share: Array, heights: Array) -> list[occ.gp_Pnt]:
    places = MILLIMETRES * (start + (end - start) * share)
    return [occ.Pnt(float(x), float(y), 0) for x, y in zip(places, heights, strict=True)]


def segments(points: Sequence[tuple[float, float]]) -> list[occ.TopoDS_Shape]:
    """Draw segments between consecutive points of the xy plane [mm]; no segment between equal points."""
    pairs = pairwise(points)
    return [occ.Segment(occ.Pnt(*a, 0), occ.Pnt(*b, 0)) for a, b in pairs if np.hypot(b[0] - a[0], b[1] - a[1]) > _SAME]


def arc(points: Sequence[tuple[float, float]]) -> occ.TopoDS_Shape:
    """Draw the arc of a circle through three points of the xy plane [mm]."""
    return occ.ArcOfCircle(*(occ.Pnt(*point, 0) for point in points))


def extrude_outline(edges: Sequence[occ.TopoDS_Shape], width: float) -> occ.TopoDS_Shape:
    """Extrude a closed outline in the xy plane over a width [mm], on both sides of the plane.

    The outline is counter-clockwise: the extrusion along +z then gives a positive volume.

    >>> round(extrude_outline(segments([(0, 0), (1, 0), (1, 1), (0, 0)]), 2.0).mass, 9)
    1.0
    """
    return occ.Face(occ.Wire(edges)).Extrude(occ.Vec(0, 0, width)).Move(occ.Vec(0, 0, -0.5 * width))
