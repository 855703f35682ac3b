"""A hinge as a specimen: drawn at the origin, with a stub of its full height grown on each end where its profile rises to one.

Hinge and stubs are one outline, so that half-circle arcs are drawn whole: they end square on the stubs' flanks, not on a face they touch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from netgen import occ

from flexstage.base.number import Number
from flexstage.mechanism.outline import rise as cut_height
from flexstage.parts.leaf import Leaf
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Elliptic, Filleted, Profile, Straight, length
from flexstage.parts.rod import Rod
from flexstage.readings.solid.draw import MILLIMETRES

START, END = "start", "end"
"""Names of the specimen's two outer faces, towards -x and +x."""

_NEAR = 1e-6
"""Relative to the hinge's length: what counts as lying in a plane."""
_LONG = 3.0
"""Elements of a rod over its radius."""
_FLAT, _FLAT_STRAIGHT = 1.0 / 12.0, 1.0 / 3.0
"""Least element over the smaller of width and length of a wide hinge: with arcs, and a leaf."""

Hinge: TypeAlias = Notch | Neck | Leaf | Rod
"""What a specimen is made of."""

_Curve = list[occ.TopoDS_Shape]


@dataclass(frozen=True)
class Specimen:
    """A drawn hinge with its stubs [mm]: the solid with faces `start` and `end`, sizes set on its edges, and the `largest` element."""

    solid: occ.TopoDS_Shape
    largest: float


@dataclass(frozen=True)
class _Side:
    """One side of an outline [mm]: half the thickness at the neck, the profile, the length of the stubs."""

    rise: float
    profile: Profile
    stub: float

    @property
    def half(self) -> float:
        return 0.5 * _mm(length(self.profile))

    @property
    def height(self) -> float:
        return self.rise + _mm(cut_height(self.profile))

    @property
    def reach(self) -> float:
        return self.half + self.stub


def specimen(part: Hinge, stub: float, size: float) -> Specimen:
    """Draw a hinge with stubs of a given length [m]; elements at the neck are `size` times its thickness.

    A notch, leaf or rectangular neck is thin along y and wide along z; a round one is revolved about x.

    >>> bar = specimen(Leaf("steel", 1e-3, 1e-3, 2e-3), 0.0, 1.0)
    >>> round(bar.solid.mass, 9), sorted(face.name for face in bar.solid.faces if face.name)
    (2.0, ['end', 'start'])
    """
    if isinstance(part, Rod):
        side = _Side(0.5 * _mm(part.diameter), Straight(part.length), 0.0)
        return _named(_revolved(side), side, _LONG * side.rise, size)
    if isinstance(part, Leaf):
        return _wide(_Side(0.5 * _mm(part.thickness), Straight(part.length), 0.0), _mm(part.width), size)
    side = _Side(0.5 * _mm(part.thickness), part.profile, stub * MILLIMETRES)
    if isinstance(part, Notch):
        return _wide(side, _mm(part.width), size)
    if part.width is None:
        return _named(_revolved(side), side, 2.0 * side.rise, size)
    across = _Side(0.5 * _mm(part.width), part.profile, side.stub)
    turned = _extruded(across, 3.0 * side.height).Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.X), 90.0)
    return _named(_extruded(side, 3.0 * across.height) * turned, side, 2.0 * min(side.rise, across.rise), size)


def _mm(value: Number) -> float:
    return float(np.real(value)) * MILLIMETRES


def _extruded(side: _Side, width: float) -> occ.TopoDS_Shape:
    upper, lower = _edge(side, 1.0), _edge(side, -1.0)
    right = _lines([(side.reach, -side.height), (side.reach, side.height)])
    left = _lines([(-side.reach, side.height), (-side.reach, -side.height)])
    face = occ.Face(occ.Wire([*lower, *right, *reversed(upper), *left]))
    return face.Extrude(occ.Vec(0, 0, width)).Move(occ.Vec(0, 0, -0.5 * width))


def _revolved(side: _Side) -> occ.TopoDS_Shape:
    ends = [(side.reach, side.height), (side.reach, 0.0), (-side.reach, 0.0), (-side.reach, side.height)]
    face = occ.Face(occ.Wire([*_edge(side, 1.0), *_lines(ends)]))
    return face.Revolve(occ.Axis(occ.Pnt(0, 0, 0), occ.X), 360.0)


def _edge(side: _Side, sign: float) -> _Curve:
    """The outline's edge from -x to +x, above the axis or below it."""
    if isinstance(side.profile, Straight):
        return _lines([(-side.half, sign * side.rise), (side.half, sign * side.rise)])
    reach, top = side.reach, sign * side.height
    start, end = _lines([(-reach, top), (-side.half, top)]), _lines([(side.half, top), (reach, top)])
    return [*start, *_cut(side, sign), *end]


def _cut(side: _Side, sign: float) -> _Curve:
    """Two quarter arcs and what is straight between them: they meet at the neck, where the mesh is to be fine."""
    if isinstance(side.profile, Elliptic):
        return _ellipse(side, sign)
    height = side.height - side.rise
    along = height if isinstance(side.profile, Filleted) else side.half
    flat = side.half - along

    def at(angle: float) -> tuple[float, float]:
        shift = flat if angle > 0.0 else -flat
        return shift + along * np.sin(angle), sign * (side.rise + height * (1.0 - np.cos(angle)))

    tiny = np.finfo(float).tiny
    middle = _lines([at(-tiny), at(tiny)]) if flat > _NEAR * side.half else []
    return [_arc(at, -0.5 * np.pi, -tiny), *middle, _arc(at, tiny, 0.5 * np.pi)]


def _arc(at: Callable[[float], tuple[float, float]], first: float, last: float) -> occ.TopoDS_Shape:
    points = [occ.Pnt(*at(angle), 0) for angle in (first, 0.5 * (first + last), last)]
    return occ.ArcOfCircle(*points)


def _ellipse(side: _Side, sign: float) -> _Curve:
    """The two quarters of a half ellipse that meet at the neck; angles count from the longer axis, as the kernel's do."""
    along, across = side.half, side.height - side.rise
    flat = along >= across
    axes = occ.gp_Ax2d(occ.gp_Pnt2d(0.0, sign * side.height), occ.gp_Dir2d(1.0, 0.0) if flat else occ.gp_Dir2d(0.0, 1.0))
    curve = occ.Ellipse(axes, max(along, across), min(along, across))
    starts = (np.pi, 1.5 * np.pi) if sign > 0.0 else (0.5 * np.pi, 0.0)
    offset = 0.0 if flat else 0.5 * np.pi
    return [curve.Trim(start - offset, start - offset + 0.5 * np.pi).Edge() for start in starts]


def _lines(points: list[tuple[float, float]]) -> _Curve:
    return [occ.Segment(occ.Pnt(*a, 0), occ.Pnt(*b, 0)) for a, b in pairwise(points)]


def _wide(side: _Side, width: float, size: float) -> Specimen:
    """Elements of a wide thin hinge may be flat: those of high order do not mind, and cubes would be too many."""
    flat = _FLAT_STRAIGHT if isinstance(side.profile, Straight) else _FLAT
    return _named(_extruded(side, width), side, max(2.0 * side.rise, flat * min(width, 2.0 * side.half)), size)


def _named(solid: occ.TopoDS_Shape, side: _Side, thin: float, size: float) -> Specimen:
    """Name the outer faces, and ask for fine elements where the section is thinnest."""
    solid.mat("medium 0")
    near = _NEAR * side.half
    flat = side.half - (side.height - side.rise) if isinstance(side.profile, Filleted) else 0.0
    for face in solid.faces:
        if all(abs(vertex.p.x - side.reach) < near for vertex in face.vertices):
            face.name = END
        elif all(abs(vertex.p.x + side.reach) < near for vertex in face.vertices):
            face.name = START
    for edge in solid.edges:
        if all(abs(vertex.p.x) <= flat + near for vertex in edge.vertices):
            edge.maxh = size * thin
    return Specimen(solid, size * (thin if isinstance(side.profile, Straight) else max(thin, side.height)))
