"""The edge of a hinge in millimetres: its profile as CAD curves, and the solids of one or two such edges.

Arcs that would be tangent to an end face are shortened, or end with a blunted wedge: two tangent faces form a wedge of angle zero, which
cannot be meshed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from netgen import occ

from flexstage.parts.profile import Contour, Elliptic, Filleted, Profile, Straight, length
from flexstage.parts.profile import rise as cut_height
from flexstage.solid.fea.geometry.contour import arc, contour_edges, extrude_outline, segments
from flexstage.solid.fea.geometry.piece import millimetres

SHORTENED = 0.03
"""Shortening of arcs that would be tangent to an end face, divided by their radius."""
BLUNTED = 0.06
"""Thickness of the blunted wedge between an arc and a rigid face, divided by the arc's smaller semi-axis."""
_STATIONS = 33

_Curve = list[occ.TopoDS_Shape]


@dataclass(frozen=True)
class HingeEdge:
    """One edge of a hinge's outline [mm]: half the thickness at the neck, the profile, and the lengths of the stubs at both ends.

    An arc next to a stub is complete; at an end without a stub it is a blunted wedge. In a stage (`stubs` are `None`) arcs are shortened,
    and end with a step to the full height.
    """

    rise: float
    profile: Profile
    stubs: tuple[float, float] | None = None

    @property
    def half(self) -> float:
        """Half the length of the hinge."""
        return 0.5 * millimetres(length(self.profile))

    @property
    def depth(self) -> float:
        """Height of the cut; with stubs, the difference of the heights (its rounding can change a mesh)."""
        return millimetres(cut_height(self.profile)) if self.stubs is None else self.height - self.rise

    @property
    def height(self) -> float:
        """Half the full thickness."""
        return self.rise + millimetres(cut_height(self.profile))

    @property
    def along(self) -> float:
        """Semi-axis of the arcs along the hinge."""
        return self.depth if isinstance(self.profile, Filleted) else self.half

    @property
    def ends(self) -> tuple[float, float]:
        """Start and end along x."""
        first, last = self.stubs or (0.0, 0.0)
        return -self.half - first, self.half + last

    @property
    def angles(self) -> tuple[float, float]:
        """Start and end of the arcs."""
        if self.stubs is None:
            largest = float(np.arcsin(1.0 - SHORTENED))
            return -largest, largest
        blunt = float(np.arcsin(1.0 - BLUNTED * min(1.0, self.depth / self.along))) if self.depth > 0.0 else 0.5 * np.pi
        first, last = (0.5 * np.pi if stub > 0.0 else blunt for stub in self.stubs)
        return -first, last

    @property
    def tops(self) -> tuple[float, float]:
        """Heights at the start and the end."""
        if self.stubs is None or isinstance(self.profile, Contour):
            return self.height, self.height
        first, last = (self.rise + self.depth * (1.0 - float(np.cos(angle))) for angle in self.angles)
        return first, last

    def at(self, angle: float, sign: float) -> tuple[float, float]:
        """Return the point of the arcs at an angle, above the axis (`sign` 1) or below it (-1)."""
        flat = self.half - self.along
        return (flat if angle > 0.0 else -flat) + self.along * np.sin(angle), sign * (self.rise + self.depth * (1.0 - np.cos(angle)))


def extrude(edge: HingeEdge, width: float) -> occ.TopoDS_Shape:
    """Draw a hinge with the edge on both sides of the xz plane, extruded over the width.

    >>> round(extrude(HingeEdge(0.5, Straight(2e-3)), 3.0).mass, 9)
    6.0
    """
    upper, lower = _curve(edge, 1.0), _curve(edge, -1.0)
    (start, end), (first, last) = edge.ends, edge.tops
    right, left = segments([(end, -last), (end, last)]), segments([(start, first), (start, -first)])
    return extrude_outline([*lower, *right, *reversed(upper), *left], width)


def revolve(edge: HingeEdge) -> occ.TopoDS_Shape:
    """Draw a round hinge: the edge revolved about x.

    >>> round(revolve(HingeEdge(0.5, Straight(4e-3))).mass, 9) == round(np.pi, 9)
    True
    """
    (start, end), (first, last) = edge.ends, edge.tops
    rest = [(end, last), (end, 0.0), (start, 0.0), (start, first)]
    face = occ.Face(occ.Wire([*_curve(edge, 1.0), *segments(rest)]))
    return face.Revolve(occ.Axis(occ.Pnt(0, 0, 0), occ.X), 360.0)


def _curve(edge: HingeEdge, sign: float) -> _Curve:
    """The curve from -x to +x, above the axis or below it."""
    if isinstance(edge.profile, Straight):
        return segments([(-edge.half, sign * edge.rise), (edge.half, sign * edge.rise)])
    (start, end), (first, last) = edge.ends, edge.tops
    if isinstance(edge.profile, Contour):
        curve, near, far = contour_edges(edge.profile, edge.rise, sign), (-edge.half, sign * first), (edge.half, sign * last)
    else:
        curve, (near, far) = _arcs(edge, sign), (edge.at(angle, sign) for angle in edge.angles)
    left = segments([(start, sign * first), (near[0], sign * first), near])
    return [*left, *curve, *segments([far, (far[0], sign * last), (end, sign * last)])]


def _arcs(edge: HingeEdge, sign: float) -> _Curve:
    """Two arcs with straight parts between them, which meet at the neck, where the mesh must be fine; one smooth curve in a stage."""
    (first, last), tiny = edge.angles, np.finfo(float).tiny
    if edge.stubs is None and not isinstance(edge.profile, Filleted):
        if not isinstance(edge.profile, Elliptic):
            return [_arc(edge, sign, first, last)]
        return [occ.SplineInterpolation([occ.Pnt(*edge.at(float(angle), sign), 0) for angle in np.linspace(first, last, _STATIONS)])]
    if isinstance(edge.profile, Elliptic):
        return _ellipse(edge, sign)
    return [_arc(edge, sign, first, -tiny), *segments([edge.at(-tiny, sign), edge.at(tiny, sign)]), _arc(edge, sign, tiny, last)]


def _arc(edge: HingeEdge, sign: float, first: float, last: float) -> occ.TopoDS_Shape:
    return arc([edge.at(angle, sign) for angle in (first, 0.5 * (first + last), last)])


def _ellipse(edge: HingeEdge, sign: float) -> _Curve:
    """The two quarters of a half ellipse that meet at the neck; angles are from the longer axis, as in the kernel."""
    along, across = edge.half, edge.depth
    flat = along >= across
    axes = occ.gp_Ax2d(occ.gp_Pnt2d(0.0, sign * edge.height), occ.gp_Dir2d(1.0, 0.0) if flat else occ.gp_Dir2d(0.0, 1.0))
    curve = occ.Ellipse(axes, max(along, across), min(along, across))
    offset = 0.0 if flat else 0.5 * np.pi
    middle = (1.5 if sign > 0.0 else 0.5) * np.pi - offset
    first, last = (angle if sign > 0.0 else -angle for angle in edge.angles)
    near, far = sorted((middle + first, middle)), sorted((middle, middle + last))
    return [curve.Trim(*between).Edge() for between in (near, far)]
