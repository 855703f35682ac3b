"""CAD of a component: its pieces as one solid for each medium, with conforming faces between the solids and named interface faces."""

from __future__ import annotations

import operator
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np
from netgen import occ

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.base.session import SESSION
from flexstage.parts.body import Cylinder, Imported, SolidWithHoles, Sphere
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.geometry.draw import draw_form, draw_piece
from flexstage.solid.fea.geometry.mirror import MIRRORS, Mirrors, cut_at_mirrors, is_symmetric
from flexstage.solid.fea.geometry.piece import MILLIMETRES, Form, Medium, Piece, coordinates, is_mirrored
from flexstage.solid.fea.jobs.content import KEPT
from flexstage.solid.fea.meshing.fineness import is_thin
from flexstage.solid.fea.solver.component import Component, Joint, groups

_TOLERANCE = 1e-3
"""Faces match within this distance [mm]."""
_AREA = 1e-4
"""Areas of faces match within this fraction."""
_WITHIN, _ALONG = 1e-9, 1.0 - 1e-9
"""Largest distance [m] of a point in a plane from the plane, and the smallest cosine between directions that count as equal."""

_PLATE = 0.22
"""Cylinders shorter than this fraction of their diameter are plates: their usual elements are smaller than their curvature requires."""


@dataclass(frozen=True)
class Cad:
    """A drawn component: `shape` [mm] has faces named `faces`, and for each of `media` one solid, named `medium 0`, ....

    If the component is cut at `mirrors`, `shape` is its positive side.
    """

    shape: occ.TopoDS_Shape
    media: tuple[Medium, ...]
    faces: tuple[str, ...]
    mirrors: Mirrors = Mirrors()


def cad(component: Component) -> Cad:
    """Draw a component: pieces of one medium are fused; pieces of different media are glued over common faces.

    Faces are named after the joints at interfaces and at the ground. Raises `DesignError` for joints without a matching flat face and for
    pieces that do not form one solid.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> drawing = cad(bar())
    >>> round(drawing.shape.mass, 6), drawing.faces  # mm^3
    (10000.0, ('end', 'foot'))
    """
    media = tuple(dict.fromkeys(piece.medium for piece in component.pieces))
    solids = [reduce(operator.add, [draw_piece(piece) for piece in component.pieces if piece.medium == medium]) for medium in media]
    for number, solid in enumerate(solids):
        solid.mat(f"medium {number}")
    shape = solids[0] if len(solids) == 1 else occ.Glue(solids)
    require(_pieces_of(component, shape))
    shape = _name_solids(shape, footprints(component))
    joints = [*(item.joint for item in component.interfaces), *component.fixed]
    require(finding for joint in joints if (finding := _name_face(shape, joint)) is not None)
    return Cad(shape, media, tuple(joint.name for joint in joints))


def cut_component(component: Component, drawing: Cad) -> Cad:
    """Return the positive side of a component's drawing, cut at its symmetry planes.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> round(cut_component(bar(), cad(bar())).shape.mass, 6)  # mm^3
    2500.0
    """
    mirrors = mirrors_of(component)
    return replace(drawing, shape=cut_at_mirrors(drawing.shape, mirrors), mirrors=mirrors) if mirrors.axes else drawing


@SESSION.keep(1)
def mirrors_of(component: Component) -> Mirrors:
    """Return the planes normal to y and z about which a component of one medium is symmetric and can be cut.

    Each joint, link and body must itself be symmetric about the plane. Leaves are cut only if they are thin, and only across their width.
    Other cuts would make the flat elements of a leaf even flatter, or leave fewer elements across the leaf. Stacks, rods, cylinders (except
    round plates), spheres and round holes are not cut. The mesher divides an arc less finely than a full circle; a round piece would
    therefore lose mass if it were cut.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> mirrors_of(bar())
    Mirrors(axes=(1, 2))
    """
    is_one = len({piece.medium for piece in component.pieces}) == 1
    return Mirrors(tuple(axis for axis in MIRRORS if is_one and _is_mirrored(component, axis)))


def _is_mirrored(component: Component, axis: int) -> bool:
    """Whether a component without round pieces is symmetric across an axis, joint by joint, link by link and body by body."""
    joints = [*(item.joint for item in component.interfaces), *component.fixed]
    links = [piece for piece in component.pieces if piece.body is None]
    frames = [*(joint.frame for joint in joints), *(piece.frame for piece in links)]
    slender = any(isinstance(piece.form, Shaped) and piece.form.slender and not _is_cut_across_width(piece, axis) for piece in links)
    return (
        not (slender or any(_is_round(piece.form) for piece in component.pieces))
        and is_mirrored(component.pieces[0].medium, axis)
        and all(abs(point[axis]) < _WITHIN for point in (*(frame.position for frame in frames), *component.bodies.values()))
        and all(np.max(np.abs(frame.rotation[axis, 1:])) > _ALONG for frame in frames)
        and all(is_symmetric(solids, axis) for solids in _solids(component))
    )


def _is_cut_across_width(piece: Piece, axis: int) -> bool:
    """Whether it is a thin leaf with its width along an axis of the component."""
    return is_thin(piece.form) and abs(float(piece.frame.rotation[axis, 2])) > _ALONG


def _is_round(form: Form) -> bool:
    """Whether it is round, and thick enough to affect the size of its elements."""
    if isinstance(form, SolidWithHoles):
        return any(map(_is_round, (form.solid, *form.holes)))
    if isinstance(form, Cylinder):
        return float(np.real(form.length)) > _PLATE * float(np.real(form.diameter if form.bore is None else form.bore))
    return isinstance(form, Sphere) or (isinstance(form, Shaped) and form.is_axisymmetric and form.is_prismatic)


def _solids(component: Component) -> Iterator[list[occ.TopoDS_Shape]]:
    """The solids of each link, of each body, and those that imprint each foreign joint."""
    for members in groups(component).values():
        yield [draw_piece(component.pieces[number]) for number in members]
    for piece in footprints(component):
        yield [draw_piece(piece)]


def footprints(component: Component) -> tuple[Piece, ...]:
    """Return the links of other components whose end faces are imprinted on a component.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> footprints(bar())
    ()
    """
    return tuple(item.footprint for item in component.interfaces if item.footprint is not None)


def _pieces_of(component: Component, shape: occ.TopoDS_Shape) -> Iterator[Finding]:
    """Check that all solids are connected by faces, including glued media; separate groups have a gap."""
    if len(shape.solids) == 1:
        return
    groups: list[set[tuple[float, ...]]] = []
    for solid in shape.solids:
        faces = {tuple(np.round((*coordinates(face.center), face.mass), 6)) for face in solid.faces}
        touching = [group for group in groups if group & faces]
        groups = [group for group in groups if not group & faces] + [set.union(faces, *touching)]
    if len(groups) > 1:
        names = ", ".join(piece.name for piece in component.pieces)
        yield Finding(component.name, f"its pieces ({names}) form {len(groups)} separate solids", "Make their outlines touch")


def _name_solids(shape: occ.TopoDS_Shape, foreign: Sequence[Piece]) -> occ.TopoDS_Shape:
    """The shape with the end faces of foreign links imprinted on it."""
    stamps = [draw_piece(piece) for piece in foreign]
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
    # A face around the joint (an annulus) has the same centre but another area.
    area = joint.area * MILLIMETRES**2
    nearest = min(flat, key=lambda face: abs(face.mass - area) / area + _distance(face, origin) / np.sqrt(area), default=None)
    if nearest is None or _distance(nearest, origin) > _TOLERANCE or abs(nearest.mass - area) > _AREA * area:
        best = "" if nearest is None else f"the best face in its plane has an area of {nearest.mass:.4g} mm^2 instead of {area:.4g} mm^2"
        found = "no flat face is in its plane" if nearest is None else f"{best}; its centre is {_distance(nearest, origin):.3g} mm off"
        what = f"the end face of {joint.link} does not meet {joint.body}: {found}"
        return Finding(joint.name, what, "Move the outline so that it covers the end face")
    nearest.name = joint.name
    return None


def _distance(face: occ.Face, origin: Array) -> float:
    return float(np.linalg.norm(coordinates(face.center) - origin))


def _is_flat(face: occ.Face, origin: Array, normal: Array) -> bool:
    """Whether all of the face lies in the plane through `origin`."""
    points = (*(vertex.p for vertex in face.vertices), face.center)
    return all(abs(float(normal @ (coordinates(point) - origin))) <= _TOLERANCE for point in points)


def region(piece: Piece, points: Array) -> Array:
    """Estimate distances (n,) [m] of points (n, 3) from a piece: largest component of the vector from its bounding box, 0 inside the box.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> region(bar().pieces[0], np.array([[0.05, 0.0, 0.0], [0.05, 0.0, 0.007]])).round(9).tolist()
    [0.0, 0.002]
    """
    local = (points - piece.frame.position) @ piece.frame.rotation
    return np.max(np.maximum(np.abs(local) - half_extents(piece), 0.0), axis=1)


@SESSION.keep(KEPT)
def half_extents(piece: Piece) -> Array:
    """Return half the side lengths (3,) [m] of a piece's bounding box in the piece's own frame.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> half_extents(bar().pieces[0]).round(9).tolist()
    [0.05, 0.005, 0.005]
    """
    if isinstance(piece.form, Imported):
        return 0.5 * np.real(np.array(piece.form.size))
    low, high = draw_form(piece.form).bounding_box
    return 0.5 * (coordinates(high) - coordinates(low)) / MILLIMETRES
