"""Specimen of a hinge: the hinge drawn at the origin, with a stub of the adjacent block at each end on an elastic block.

If a profile rises to a block, the stub has the hinge's full height, and hinge and stub are one outline. Half-circle arcs next to a stub are
drawn completely: they end perpendicular to the stub's flank, without tangent faces. An arc that would be tangent to a rigid face ends at
its true end with a blunted wedge. A sharp wedge could not be meshed, and would carry almost no load. Hinges with any other profile end on a
stub that is larger than the hinge on all sides.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
from netgen import occ

from flexstage.parts.profile import Contour, Elliptic, Filleted, Profile, Straight, length
from flexstage.parts.profile import rise as cut_height
from flexstage.parts.section import Circle, Rectangle, Section
from flexstage.parts.shape import Profiled, Shaped
from flexstage.solid.fea.geometry.contour import contour_edges, segments
from flexstage.solid.fea.geometry.mirror import Mirrors, cut_at_mirrors, is_symmetric
from flexstage.solid.fea.geometry.piece import MILLIMETRES, millimetres
from flexstage.solid.fea.hinges.roots import rises
from flexstage.solid.fea.meshing.fineness import THIN

START, END = "start", "end"
"""Names of the specimen's two outer faces, towards -x and +x."""

BLUNTED = 0.06
"""Thickness of the blunted wedge between an arc and a rigid face, divided by the arc's smaller semi-axis."""

_NEAR = 1e-6
"""Tolerance for points in a plane, divided by the hinge's length."""
_LONG = 1.5
"""Largest element of a rod, divided by the diameter of the rod."""
_FLAT, _FLAT_STRAIGHT = 1.0 / 12.0, 1.0 / 3.0
"""Smallest element of a wide hinge, divided by the smaller of its width and length: for a hinge with arcs, and for a leaf."""
_SMOOTH = 0.5
"""Largest element of a thin hinge, divided by sqrt(length x thickness / 2), over which strains vary."""
_SEAT = 5.0
"""Size of a block beyond a hinge whose profile does not rise, sideways and in depth, divided by the hinge's `grain`."""
_SEAT_SIZE = 2.0
"""Largest element of a block beyond a hinge whose profile does not rise, divided by the hinge's `grain`."""

_Curve = list[occ.TopoDS_Shape]


@dataclass(frozen=True)
class Specimen:
    """A drawn hinge with stubs [mm]: `solid` has the faces `start` and `end` and element sizes on edges; `largest` is the largest size."""

    solid: occ.TopoDS_Shape
    largest: float
    mirrors: Mirrors = Mirrors()

    def cut(self, across: Iterable[int]) -> Specimen:
        """Return the positive side of the specimen, cut at the symmetry planes normal to some axes (1: y, 2: z)."""
        mirrors = Mirrors(tuple(axis for axis in across if is_symmetric([self.solid], axis)))
        return replace(self, solid=cut_at_mirrors(self.solid, mirrors), mirrors=mirrors)


@dataclass(frozen=True)
class _Side:
    """One side of an outline [mm]: half the thickness at the neck, the profile, the lengths of both stubs."""

    rise: float
    profile: Profile
    stubs: tuple[float, float] = (0.0, 0.0)

    @property
    def half(self) -> float:
        return 0.5 * millimetres(length(self.profile))

    @property
    def height(self) -> float:
        return self.rise + millimetres(cut_height(self.profile))

    @property
    def ends(self) -> tuple[float, float]:
        """Start and end of the specimen along x."""
        first, last = self.stubs
        return -self.half - first, self.half + last

    @property
    def angles(self) -> tuple[float, float]:
        """Start and end of the arcs: complete on a stub's flank; blunted wedges at a rigid face."""
        rise = self.height - self.rise
        along = rise if isinstance(self.profile, Filleted) else self.half
        blunt = float(np.arcsin(1.0 - BLUNTED * min(1.0, rise / along))) if rise > 0.0 else 0.5 * np.pi
        first, last = (0.5 * np.pi if stub > 0.0 else blunt for stub in self.stubs)
        return -first, last

    @property
    def tops(self) -> tuple[float, float]:
        """Heights at the start and the end."""
        if isinstance(self.profile, Contour):
            return self.height, self.height
        first, last = (self.rise + (self.height - self.rise) * (1.0 - float(np.cos(angle))) for angle in self.angles)
        return first, last


def grain(part: Shaped) -> float:
    """Return a length scale of the hinge's end [m]: the thickness, or sqrt(thickness x width) if the hinge bends both ways.

    >>> from flexstage.parts.neck import Neck
    >>> grain(Neck("steel", 1e-3, Straight(0.01), width=4e-3))
    0.002
    """
    end = part.end.first
    return float(np.sqrt(end.height * end.width) if part.bends_both_ways else end.thinnest)


def own_stub(part: Shaped) -> tuple[Section, float]:
    """Return section and length [m] of a hinge's stub: the section of the hinge's end if the profile `rises`, else a larger section.

    >>> from flexstage.parts.leaf import Leaf
    >>> section, depth = own_stub(Leaf("steel", 0.01, 1e-3, 5e-3))
    >>> section.height, section.width, depth
    (0.011, 0.015, 0.005)
    """
    end = part.end.first
    if rises(part):
        return end, float(end.height)
    beyond = _SEAT * grain(part)
    block = Circle if end.is_axisymmetric else Rectangle
    return block(end.height + 2.0 * beyond, end.width + 2.0 * beyond), beyond


def cut(part: Profiled, stubs: tuple[float, float], size: float) -> Specimen:
    """Draw a hinge with a profile, and its stubs of lengths `stubs` [mm]. Arcs next to a stub are complete, other arcs are blunted.

    A straight profile is drawn as a `bar`. A notch is thin along y and wide along z; a round neck is revolved about x.
    """
    if part.is_prismatic:
        return bar(part, stubs, size)
    if not rises(part):
        return bar(part, stubs, size, _draw_cut(part, (0.0, 0.0), size).solid)
    return _draw_cut(part, stubs, size)


def _draw_cut(part: Profiled, stubs: tuple[float, float], size: float) -> Specimen:
    side = _Side(0.5 * millimetres(part.throat.height), part.profile, stubs)
    if part.is_axisymmetric:
        return _name_faces(_revolve(side), side, 2.0 * side.rise, size)
    if part.end.first.width == part.throat.first.width:
        return _wide(side, millimetres(part.throat.width), size)
    across = _Side(0.5 * millimetres(part.throat.width), part.profile, stubs)
    turned = _extrude(across, 3.0 * side.height).Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.X), 90.0)
    return _name_faces(_extrude(side, 3.0 * across.height) * turned, side, 2.0 * min(side.rise, across.rise), size)


def bar(part: Shaped, stubs: tuple[float, float], size: float, drawn: occ.TopoDS_Shape | None = None) -> Specimen:
    """Draw a part with end blocks of the lengths `stubs` [mm]; `drawn` [mm] is the part's solid (default: a prism of its section)."""
    side = _Side(0.5 * millimetres(part.end.height), Straight(part.span), stubs)
    solid = _prism(part) if drawn is None else drawn
    thin = _thinness(part)
    if not any(stubs):
        return _name_faces(solid, side, thin, size)
    for sign, depth in zip((-1.0, 1.0), stubs, strict=True):
        if depth > 0.0:
            solid = solid + _block(part, sign, side.half, depth)
    coarse = 2.0 * side.rise if rises(part) else _SEAT_SIZE * grain(part) * MILLIMETRES
    return replace(_name_faces(solid, side, thin, size), largest=size * max(thin, coarse))


def _prism(part: Shaped) -> occ.TopoDS_Shape:
    side = _Side(0.5 * millimetres(part.throat.height), Straight(part.span))
    return _revolve(side) if part.is_axisymmetric else _extrude(side, millimetres(part.throat.width))


def _thinness(part: Shaped) -> float:
    """Largest element [mm] at the thinnest section: those of leaves may be flat."""
    thin = millimetres(part.throat.thinnest)
    if part.bends_both_ways:
        return _LONG * thin if part.slender else thin
    return max(thin, _FLAT_STRAIGHT * min(millimetres(part.throat.width), millimetres(part.span)))


def _block(part: Shaped, sign: float, start: float, depth: float) -> occ.TopoDS_Shape:
    """The block [mm] at one end of a hinge."""
    section, _ = own_stub(part)
    high, wide = millimetres(section.height), millimetres(section.width)
    if section.is_axisymmetric:
        return occ.Cylinder(occ.Pnt(sign * start, 0, 0), occ.X if sign > 0.0 else -occ.X, 0.5 * high, depth)
    low, top = sorted((sign * start, sign * (start + depth)))
    return occ.Box(occ.Pnt(low, -0.5 * high, -0.5 * wide), occ.Pnt(top, 0.5 * high, 0.5 * wide))


def _extrude(side: _Side, width: float) -> occ.TopoDS_Shape:
    upper, lower = _edge(side, 1.0), _edge(side, -1.0)
    (start, end), (first, last) = side.ends, side.tops
    right, left = segments([(end, -last), (end, last)]), segments([(start, first), (start, -first)])
    face = occ.Face(occ.Wire([*lower, *right, *reversed(upper), *left]))
    return face.Extrude(occ.Vec(0, 0, width)).Move(occ.Vec(0, 0, -0.5 * width))


def _revolve(side: _Side) -> occ.TopoDS_Shape:
    (start, end), (first, last) = side.ends, side.tops
    rest = [(end, last), (end, 0.0), (start, 0.0), (start, first)]
    face = occ.Face(occ.Wire([*_edge(side, 1.0), *segments(rest)]))
    return face.Revolve(occ.Axis(occ.Pnt(0, 0, 0), occ.X), 360.0)


def _edge(side: _Side, sign: float) -> _Curve:
    """The outline's edge from -x to +x, above the axis or below it."""
    if isinstance(side.profile, Straight):
        return segments([(-side.half, sign * side.rise), (side.half, sign * side.rise)])
    (start, end), (first, last) = side.ends, side.tops
    if isinstance(side.profile, Contour):
        curve, near, far = contour_edges(side.profile, side.rise, sign), (-side.half, sign * first), (side.half, sign * last)
    else:
        curve, near, far = _cut(side, sign)
    return [*segments([(start, sign * first), near]), *curve, *segments([far, (end, sign * last)])]


def _cut(side: _Side, sign: float) -> tuple[_Curve, tuple[float, float], tuple[float, float]]:
    """Two arcs with straight parts between them, and their start and end: they meet at the neck, where the mesh must be fine."""
    height = side.height - side.rise
    along = height if isinstance(side.profile, Filleted) else side.half
    flat = side.half - along

    def at(angle: float) -> tuple[float, float]:
        shift = flat if angle > 0.0 else -flat
        return shift + along * np.sin(angle), sign * (side.rise + height * (1.0 - np.cos(angle)))

    first, last = side.angles
    if isinstance(side.profile, Elliptic):
        return _ellipse(side, sign), at(first), at(last)
    tiny = np.finfo(float).tiny
    middle = segments([at(-tiny), at(tiny)]) if flat > _NEAR * side.half else []
    return [_arc(at, first, -tiny), *middle, _arc(at, tiny, last)], at(first), at(last)


def _arc(at: Callable[[float], tuple[float, float]], first: float, last: float) -> occ.TopoDS_Shape:
    points = [occ.Pnt(*at(angle), 0) for angle in (first, 0.5 * (first + last), last)]
    return occ.ArcOfCircle(*points)


def _ellipse(side: _Side, sign: float) -> _Curve:
    """The two quarters of a half ellipse that meet at the neck; angles are from the longer axis, as in the kernel."""
    along, across = side.half, side.height - side.rise
    flat = along >= across
    axes = occ.gp_Ax2d(occ.gp_Pnt2d(0.0, sign * side.height), occ.gp_Dir2d(1.0, 0.0) if flat else occ.gp_Dir2d(0.0, 1.0))
    curve = occ.Ellipse(axes, max(along, across), min(along, across))
    offset = 0.0 if flat else 0.5 * np.pi
    middle = (1.5 if sign > 0.0 else 0.5) * np.pi - offset
    first, last = (angle if sign > 0.0 else -angle for angle in side.angles)
    near, far = sorted((middle + first, middle)), sorted((middle, middle + last))
    return [curve.Trim(*between).Edge() for between in (near, far)]


def _wide(side: _Side, width: float, size: float) -> Specimen:
    """Elements of a wide thin hinge may be flat: sufficient at high order, and cubes would be too many."""
    short = min(width, 2.0 * side.half)
    flat = _FLAT * short if short <= 2.0 * THIN * side.rise else min(_FLAT * short, _SMOOTH * float(np.sqrt(2.0 * side.half * side.rise)))
    return _name_faces(_extrude(side, width), side, max(2.0 * side.rise, flat), size)


def _name_faces(solid: occ.TopoDS_Shape, side: _Side, thin: float, size: float) -> Specimen:
    """Name the outer faces, and request fine elements at the thinnest section."""
    solid.mat("medium 0")
    near = _NEAR * side.half
    start, end = side.ends
    for face in solid.faces:
        if all(abs(vertex.p.x - end) < near for vertex in face.vertices):
            face.name = END
        elif all(abs(vertex.p.x - start) < near for vertex in face.vertices):
            face.name = START
    for edge in solid.edges:
        if any(all(_is_thin(vertex.p, side, between) for vertex in edge.vertices) for between in _thin_places(side)):
            edge.maxh = size * thin
    return Specimen(solid, size * (thin if isinstance(side.profile, Straight) else max(thin, side.height)))


def _is_thin(point: occ.gp_Pnt, side: _Side, between: tuple[float, float]) -> bool:
    near = _NEAR * side.half
    return between[0] - near <= abs(point.x) <= between[1] + near and abs(point.y) <= side.height + near


def _thin_places(side: _Side) -> list[tuple[float, float]]:
    """Distances from the middle between which the section is thinnest: the whole length of a prism on wider blocks."""
    if isinstance(side.profile, Contour):
        knots = np.array(side.profile.knots)
        return [(place, place) for place in MILLIMETRES * knots[side.profile.height(knots) == 0.0]]
    if isinstance(side.profile, Straight):
        return [(0.0, side.half if any(side.stubs) else 0.0)]
    return [(0.0, side.half - (side.height - side.rise) if isinstance(side.profile, Filleted) else 0.0)]
