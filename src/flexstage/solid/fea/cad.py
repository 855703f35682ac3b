"""The CAD of a component: its pieces as one conforming solid (or several, one a medium), with the faces it is joined and held by."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from netgen import occ

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.parts.body import Imported
from flexstage.solid.fea.component import Component, Interface, Joint
from flexstage.solid.fea.content import KEPT
from flexstage.solid.fea.draw import draw_form, move_solid
from flexstage.solid.fea.piece import MILLIMETRES, Medium, Piece

_TOLERANCE = 1e-3
"""Faces match within this distance [mm]."""
_AREA = 1e-4
"""... and within this share of their area."""


@dataclass(frozen=True)
class Cad:
    """A component drawn: the shape [mm] whose faces carry the names of `faces`, its solids the names `medium 0`, ... of `media`."""

    shape: occ.TopoDS_Shape
    media: tuple[Medium, ...]
    faces: tuple[str, ...]


def cad(component: Component) -> Cad:
    """Draw a component: pieces of one medium are fused, those of different media glued over their common faces.

    Faces are named after joints: interfaces and those held by the ground. Raises `DesignError` for joints without a matching flat face and
    for pieces that do not form one solid.

    >>> from flexstage.solid.fea.bar import bar
    >>> drawing = cad(bar())
    >>> round(drawing.shape.mass, 6), drawing.faces  # mm^3
    (10000.0, ('end', 'foot'))
    """
    media = tuple(dict.fromkeys(piece.medium for piece in component.pieces))
    solids = [_fuse([piece for piece in component.pieces if piece.medium == medium]) for medium in media]
    for number, solid in enumerate(solids):
        solid.mat(f"medium {number}")
    shape = solids[0] if len(solids) == 1 else occ.Glue(solids)
    require(_pieces_of(component, shape))
    shape = _name_solids(shape, component.interfaces)
    joints = [*(item.joint for item in component.interfaces), *component.fixed]
    require(finding for joint in joints if (finding := _name_face(shape, joint)) is not None)
    return Cad(shape, media, tuple(joint.name for joint in joints))


def _fuse(pieces: Sequence[Piece]) -> occ.TopoDS_Shape:
    total = move_solid(draw_form(pieces[0].form), pieces[0].frame)
    for piece in pieces[1:]:
        total = total + move_solid(draw_form(piece.form), piece.frame)
    return total


def _pieces_of(component: Component, shape: occ.TopoDS_Shape) -> Iterator[Finding]:
    """Solids that share faces, glued media included, hang together; anything else that falls apart has a gap."""
    groups: list[set[tuple[float, ...]]] = []
    for solid in shape.solids:
        faces = {tuple(np.round((*_coordinates(face.center), face.mass), 6)) for face in solid.faces}
        touching = [group for group in groups if group & faces]
        groups = [group for group in groups if not group & faces] + [set.union(faces, *touching)]
    if len(groups) > 1:
        names = ", ".join(piece.name for piece in component.pieces)
        yield Finding(component.name, f"its pieces ({names}) fall into {len(groups)} separate solids", "Let their outlines touch")


def _name_solids(shape: occ.TopoDS_Shape, interfaces: Sequence[Interface]) -> occ.TopoDS_Shape:
    """The shape with the end faces of foreign links printed on it."""
    stamps = [
        move_solid(draw_form(item.footprint), item.stamp) for item in interfaces if item.footprint is not None and item.stamp is not None
    ]
    if not stamps:
        return shape
    for stamp in stamps:
        stamp.mat("stamp")
    glued = occ.Glue([*shape.solids, *stamps])
    kept = [solid for solid in glued.solids if solid.name != "stamp"]
    return kept[0] if len(kept) == 1 else occ.Compound(kept)


def _name_face(shape: occ.TopoDS_Shape, joint: Joint) -> Finding | None:
    origin, normal = joint.frame.position * MILLIMETRES, joint.frame.rotation[:, 0]
    flat = [face for face in shape.faces if _is_flat(face, origin, normal)]
    # A face around the joint (an annulus) has the same centre: the area tells them apart.
    area = joint.area * MILLIMETRES**2
    nearest = min(flat, key=lambda face: abs(face.mass - area) / area + _distance(face, origin) / np.sqrt(area), default=None)
    if nearest is None or _distance(nearest, origin) > _TOLERANCE or abs(nearest.mass - area) > _AREA * area:
        likeliest = "" if nearest is None else f"the likeliest face there has {nearest.mass:.4g} mm^2 instead of {area:.4g}"
        found = "no flat face there" if nearest is None else f"{likeliest}, its centre {_distance(nearest, origin):.3g} mm away"
        what = f"the end face of {joint.link} does not meet {joint.body}: {found}"
        return Finding(joint.name, what, "Move the outline to touch it fully")
    nearest.name = joint.name
    return None


def _distance(face: occ.Face, origin: Array) -> float:
    return float(np.linalg.norm(_coordinates(face.center) - origin))


def _is_flat(face: occ.Face, origin: Array, normal: Array) -> bool:
    """Whether all of the face lies in the plane through `origin`."""
    low, high = (_coordinates(corner) for corner in face.bounding_box)
    middle = _coordinates(face.center)
    if abs(float(normal @ (middle - origin))) > _TOLERANCE:
        return False
    return all(abs(float(normal @ (_coordinates(vertex.p) - origin))) <= _TOLERANCE for vertex in face.vertices) and bool(
        np.all(high >= low)
    )


def _coordinates(point: occ.gp_Pnt) -> Array:
    return np.array([point.x, point.y, point.z])


def region(piece: Piece, points: Array) -> Array:
    """Distance-like measure (n,) of points (n, 3) [m] from a piece: how far outside its bounding box they are, 0 inside [m].

    >>> from flexstage.solid.fea.bar import bar
    >>> region(bar().pieces[0], np.array([[0.05, 0.0, 0.0], [0.05, 0.0, 0.007]])).round(9).tolist()
    [0.0, 0.002]
    """
    local = (points - piece.frame.position) @ piece.frame.rotation
    return np.max(np.maximum(np.abs(local) - half_extents(piece), 0.0), axis=1)


@lru_cache(maxsize=KEPT)
def half_extents(piece: Piece) -> Array:
    """Half sizes (3,) of a piece's bounding box in its own frame [m], drawn once.

    >>> from flexstage.solid.fea.bar import bar
    >>> half_extents(bar().pieces[0]).round(9).tolist()
    [0.05, 0.005, 0.005]
    """
    if isinstance(piece.form, Imported):
        return 0.5 * np.real(np.array(piece.form.size))
    low, high = draw_form(piece.form).bounding_box
    return 0.5 * (_coordinates(high) - _coordinates(low)) / MILLIMETRES
