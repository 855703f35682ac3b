"""Specimen of a hinge: the hinge drawn at the origin, with a stub of the adjacent block at each end on an elastic block.

If a profile rises to a block, the stub has the hinge's full height, and hinge and stub are one outline. Half-circle arcs next to a stub are
drawn completely: they end perpendicular to the stub's flank, without tangent faces. An arc that would be tangent to a rigid face ends at
its true end with a blunted wedge. A sharp wedge could not be meshed, and would carry almost no load. Hinges with any other profile end on a
stub that is larger than the hinge on all sides.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from netgen import occ

from flexstage.parts.profile import Contour, Filleted, Straight
from flexstage.parts.section import Circle, Rectangle, Section
from flexstage.parts.shape import Profiled, Shaped
from flexstage.solid.fea.geometry.hinge_edge import HingeEdge, extrude, revolve
from flexstage.solid.fea.geometry.mirror import Mirrors, cut_at_mirrors, is_symmetric
from flexstage.solid.fea.geometry.piece import MILLIMETRES, millimetres
from flexstage.solid.fea.hinges.roots import rises
from flexstage.solid.fea.meshing.fineness import THIN

START, END = "start", "end"
"""Names of the specimen's two outer faces, towards -x and +x."""

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
    edge = HingeEdge(0.5 * millimetres(part.throat.height), part.profile, stubs)
    if part.is_axisymmetric:
        return _name_faces(revolve(edge), edge, 2.0 * edge.rise, size)
    if part.end.first.width == part.throat.first.width:
        return _wide(edge, millimetres(part.throat.width), size)
    across = HingeEdge(0.5 * millimetres(part.throat.width), part.profile, stubs)
    turned = extrude(across, 3.0 * edge.height).Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.X), 90.0)
    return _name_faces(extrude(edge, 3.0 * across.height) * turned, edge, 2.0 * min(edge.rise, across.rise), size)


def bar(part: Shaped, stubs: tuple[float, float], size: float, drawn: occ.TopoDS_Shape | None = None) -> Specimen:
    """Draw a part with end blocks of the lengths `stubs` [mm]; `drawn` [mm] is the part's solid (default: a prism of its section)."""
    edge = HingeEdge(0.5 * millimetres(part.end.height), Straight(part.span), stubs)
    solid = _prism(part) if drawn is None else drawn
    thin = _thinness(part)
    if not any(stubs):
        return _name_faces(solid, edge, thin, size)
    for sign, depth in zip((-1.0, 1.0), stubs, strict=True):
        if depth > 0.0:
            solid = solid + _block(part, sign, edge.half, depth)
    coarse = 2.0 * edge.rise if rises(part) else _SEAT_SIZE * grain(part) * MILLIMETRES
    return replace(_name_faces(solid, edge, thin, size), largest=size * max(thin, coarse))


def _prism(part: Shaped) -> occ.TopoDS_Shape:
    edge = HingeEdge(0.5 * millimetres(part.throat.height), Straight(part.span))
    return revolve(edge) if part.is_axisymmetric else extrude(edge, millimetres(part.throat.width))


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


def _wide(edge: HingeEdge, width: float, size: float) -> Specimen:
    """Elements of a wide thin hinge may be flat: sufficient at high order, and cubes would be too many."""
    short = min(width, 2.0 * edge.half)
    flat = _FLAT * short if short <= 2.0 * THIN * edge.rise else min(_FLAT * short, _SMOOTH * float(np.sqrt(2.0 * edge.half * edge.rise)))
    return _name_faces(extrude(edge, width), edge, max(2.0 * edge.rise, flat), size)


def _name_faces(solid: occ.TopoDS_Shape, edge: HingeEdge, thin: float, size: float) -> Specimen:
    """Name the outer faces, and request fine elements at the thinnest section."""
    solid.mat("medium 0")
    near = _NEAR * edge.half
    start, end = edge.ends
    for face in solid.faces:
        if all(abs(vertex.p.x - end) < near for vertex in face.vertices):
            face.name = END
        elif all(abs(vertex.p.x - start) < near for vertex in face.vertices):
            face.name = START
    for line in solid.edges:
        if any(all(_is_thin(vertex.p, edge, between) for vertex in line.vertices) for between in _thin_places(edge)):
            line.maxh = size * thin
    return Specimen(solid, size * (thin if isinstance(edge.profile, Straight) else max(thin, edge.height)))


def _is_thin(point: occ.gp_Pnt, edge: HingeEdge, between: tuple[float, float]) -> bool:
    near = _NEAR * edge.half
    return between[0] - near <= abs(point.x) <= between[1] + near and abs(point.y) <= edge.height + near


def _thin_places(edge: HingeEdge) -> list[tuple[float, float]]:
    """Distances from the middle between which the section is thinnest: the whole length of a prism on wider blocks."""
    if isinstance(edge.profile, Contour):
        knots = np.array(edge.profile.knots)
        return [(place, place) for place in MILLIMETRES * knots[edge.profile.height(knots) == 0.0]]
    if isinstance(edge.profile, Straight):
        return [(0.0, edge.half if any(edge.stubs or ()) else 0.0)]
    return [(0.0, edge.half - edge.along if isinstance(edge.profile, Filleted) else 0.0)]
