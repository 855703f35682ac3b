"""Drawing of forms as CAD solids in millimetres, because the CAD kernel has absolute tolerances.

Every hinge is drawn at the origin and then moved, because shapes that are cut far from the origin cannot be meshed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from netgen import occ

from flexstage.base.finding import refuse
from flexstage.base.number import Array, Number
from flexstage.base.register import Register
from flexstage.parts.body import Block, Cylinder, Extrusion, Imported, Solid, SolidWithHoles, Sphere
from flexstage.parts.cruciform import Cruciform
from flexstage.parts.leaf import Leaf
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Profile, length
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.rod import Rod
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.geometry.hinge_edge import HingeEdge, extrude, revolve
from flexstage.solid.fea.geometry.imported import imported_shape
from flexstage.solid.fea.geometry.piece import MILLIMETRES, Form, Piece, millimetres
from flexstage.solid.fea.geometry.reinforced_leaf import reinforced_solid
from flexstage.solid.fea.hinges.specimen import Specimen, bar, cut
from flexstage.spatial.frame import Frame
from flexstage.spatial.rotation import rotation_vector


def draw_form(form: Form) -> occ.Solid:
    """Draw a form as a CAD solid at the origin [mm]: links are along x, with their thickness along y and their width along z.

    >>> from flexstage.parts.body import Block
    >>> round(draw_form(Block("steel", (0.01, 0.02, 0.03))).mass, 6)  # mm^3
    6000.0
    """
    return _SOLIDS[type(form)](form) if isinstance(form, Solid) else _shape(form).draw(form)


def specimen(part: Shaped, stubs: tuple[float, float], size: float) -> Specimen:
    """Draw a hinge with stubs of the lengths `stubs` [m] at its ends; the element size at the neck is `size` times the thickness.

    The hinge is thin along y and wide along z. Raises `DesignError` for a kind without a shape.

    >>> from flexstage.parts.leaf import Leaf
    >>> bar = specimen(Leaf("steel", 1e-3, 1e-3, 2e-3), (0.0, 0.0), 1.0)
    >>> round(bar.solid.mass, 9), sorted(face.name for face in bar.solid.faces if face.name)
    (2.0, ['end', 'start'])
    """
    shape, lengths = _shape(part), (stubs[0] * MILLIMETRES, stubs[1] * MILLIMETRES)
    return bar(part, lengths, size, shape.draw(part)) if shape.specimen is None else shape.specimen(part, lengths, size)


def _shape(part: Shaped) -> Shape:
    found = SHAPES.get(part.kind)
    if found is None:
        what = "no installed package has a solid shape for this kind"
        raise refuse(f"the {part.kind}", what, f"Install a package with this shape ({SHAPES.group})")
    return found


def move_solid(solid: occ.TopoDS_Shape, frame: Frame) -> occ.TopoDS_Shape:
    """Move a solid [mm], drawn at the origin, into a frame [m].

    >>> from flexstage.parts.body import Block
    >>> there = move_solid(draw_form(Block("steel", (0.01, 0.01, 0.01))), Frame(np.eye(3), np.array([0.1, 0.0, 0.0])))
    >>> round(there.center.x, 6)
    100.0
    """
    turn = rotation_vector(np.real(frame.rotation))
    angle = float(np.linalg.norm(turn))
    if angle > 0.0:
        axis = occ.Axis(occ.Pnt(0, 0, 0), occ.Dir(*(turn / angle)))
        solid = solid.Rotate(axis, float(np.rad2deg(angle)))
    return solid.Move(occ.Vec(*_point(frame.position)))


def draw_piece(piece: Piece) -> occ.TopoDS_Shape:
    """Draw a piece in its frame [mm].

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> round(draw_piece(bar().pieces[0]).center.x, 6)
    50.0
    """
    return move_solid(draw_form(piece.form), piece.frame)


def unite(pieces: Sequence[Piece]) -> occ.TopoDS_Shape:
    """Draw several pieces as one shape [mm]."""
    shapes = [draw_piece(piece) for piece in pieces]
    return shapes[0] if len(shapes) == 1 else occ.Fuse(shapes)


def _point(position: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) * MILLIMETRES for value in np.real(position))
    return x, y, z


def _box(x: object, y: object, z: object) -> occ.Solid:
    a, b, c = 0.5 * millimetres(x), 0.5 * millimetres(y), 0.5 * millimetres(z)
    return occ.Box(occ.Pnt(-a, -b, -c), occ.Pnt(a, b, c))


def _round(diameter: object, size: object) -> occ.Solid:
    half = 0.5 * millimetres(size)
    return occ.Cylinder(occ.Pnt(-half, 0, 0), occ.X, r=0.5 * millimetres(diameter), h=2.0 * half)


def _block(form: Block) -> occ.Solid:
    solid = _box(*form.size)
    return solid if form.hole is None else solid - _box(*form.hole, 2.0 * form.size[2])


def _tube(form: Cylinder) -> occ.Solid:
    solid = _round(form.diameter, form.length)
    return solid if form.bore is None else solid - _round(form.bore, 2.0 * form.length)


def _extrusion(form: Extrusion) -> occ.Solid:
    half = 0.5 * millimetres(form.height)
    return _prism([occ.Pnt(millimetres(x), millimetres(y), -half) for x, y in np.real(form.corners)], occ.Vec(0, 0, 2.0 * half))


def _prism(corners: list[occ.Pnt], along: occ.Vec) -> occ.Solid:
    sides = [occ.Segment(here, there) for here, there in pairwise([*corners, corners[0]])]
    return occ.Face(occ.Wire(sides)).Extrude(along)


def _pierced(form: SolidWithHoles) -> occ.Solid:
    drawn = draw_form(form.solid)
    for hole in form.holes:
        drawn = drawn - move_solid(draw_form(hole), hole.frame)
    return drawn


_SOLIDS: Mapping[type[Solid], Callable[[Any], occ.Solid]] = {
    Block: _block,
    Cylinder: _tube,
    Extrusion: _extrusion,
    Sphere: lambda form: occ.Sphere(occ.Pnt(0, 0, 0), 0.5 * millimetres(form.diameter)),
    Imported: imported_shape,
    SolidWithHoles: _pierced,
}


def _edge(thickness: Number, profile: Profile) -> HingeEdge:
    return HingeEdge(0.5 * millimetres(thickness), profile)


def _neck(form: Neck) -> occ.Solid:
    flat = _edge(form.thickness, form.profile)
    if form.width is None:
        return revolve(flat)
    over = millimetres(4.0 * form.width + 4.0 * form.thickness + 4.0 * length(form.profile))
    upright = extrude(_edge(form.width, form.profile), over)
    return extrude(flat, over) * upright.Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.X), 90.0)


def prism(form: Shaped) -> occ.Solid:
    """Draw a prismatic part from the corners of its section [mm]."""
    half = 0.5 * millimetres(form.span)
    return _prism([occ.Pnt(-half, millimetres(y), millimetres(z)) for y, z in form.throat.outline(np.zeros(0))], occ.Vec(2.0 * half, 0, 0))


@dataclass(frozen=True)
class Shape:
    """Functions that draw a kind of part as a CAD solid [mm]. `draw` draws the part at the origin, `specimen` draws it with stubs.

    By default, a specimen is the drawn part with blocks at its ends. Parts with a profile of cuts need `specimen.cut`, which blunts arcs at
    rigid faces. Complete arcs would meet the rigid faces at angles that cannot be meshed.
    """

    draw: Callable[[Any], occ.Solid]
    specimen: Callable[[Any, tuple[float, float], float], Specimen] | None = None


_OWN: Mapping[type[Shaped], Shape] = {
    Notch: Shape(lambda form: extrude(_edge(form.thickness, form.profile), millimetres(form.width)), cut),
    Neck: Shape(_neck, cut),
    Leaf: Shape(lambda form: _box(form.length, form.thickness, form.width), bar),
    ReinforcedLeaf: Shape(reinforced_solid),
    Rod: Shape(lambda form: _round(form.diameter, form.length), bar),
    Cruciform: Shape(prism),
    Piezo: Shape(lambda form: _round(form.diameter, form.length)),
}
SHAPES: Register[Shape] = Register("flexstage.shapes", {part.kind: shape for part, shape in _OWN.items()})
"""Shapes by kind of part."""
