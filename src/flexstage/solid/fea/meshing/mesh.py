"""Meshes: tetrahedra graded to the thickness of each neck, curved to the drawn geometry."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import ngsolve
import numpy as np
from netgen import occ
from netgen.meshing import MeshingParameters

from flexstage.base.finding import refuse, require
from flexstage.base.number import Array
from flexstage.base.session import SESSION
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.geometry.cad import Cad, cad, cut_component, half_extents, region
from flexstage.solid.fea.geometry.mirror import Mirrors
from flexstage.solid.fea.geometry.piece import MILLIMETRES, Medium, Piece, coordinates, span, thinnest
from flexstage.solid.fea.jobs.content import content
from flexstage.solid.fea.jobs.progress import Report, Stage, silent
from flexstage.solid.fea.meshing.fineness import (
    ATTEMPTS,
    Fineness,
    element_size,
    is_leaf,
    is_notch,
    is_strut,
    is_thin,
    middle_size,
    thin_findings,
)
from flexstage.solid.fea.meshing.straighten import straighten
from flexstage.solid.fea.solver.component import Component

_CURVATURE = 1.5
"""Number of segments per radius of curvature on curved faces."""
_NECK = 0.5
"""Fraction of a link's length, about its middle, over which elements are curved."""
_CORE, _AWAY = 1.0 / 6.0, 0.1
"""Elements within a round neck with an arc, on circles of half its radius about its axis. Size in the middle over that on its faces,
and its growth with the distance. From the surface alone the mesher would make flat elements, twice as wide."""
_ROUND = 0.85
"""Size of elements within round necks relative to those of the isolated neck, as its faces are coarser."""
_BENEATH = ((0.0, 2.5), (3.0, 4.0))
"""Elements at the root of a thin leaf: depth in the block over the thickness of the leaf, and size over the usual size for it."""
_FINE = 1.0 / 45.0
"""Smallest such thickness over the width of the leaf: the thinner a leaf, the less its root matters."""
_ROOT = 2.0 / 15.0
"""Size of elements around the ends of straight necks relative to the usual: the block deforms most at the edge there."""
_REACH = 1.6
"""Extent of the fine middle plane of a notch on both sides, in geometric means of radius and thickness."""
_HELD = 0.9
"""Fraction of a round neck's length over which the inside of the neck is graded."""
_PRINT = 1.0 / 3.0
"""Elements under another component's end face over the root of its area, for a neck of one. A small face needs a fine root."""
_WITHIN = 1e-6
"""Largest distance [m] between the centre of a face and the bounding box of the face's piece."""
_AT_HAND = 8
"""Number of drawings and meshes that are cached for the next order."""


@dataclass(frozen=True)
class PieceMesh:
    """A component's mesh [mm], its media by name `medium 0`, ..., named faces, and the piece (index) of each element.

    The mask `finer` selects elements in notches and thin leaves, which have one order more than the others. If the mesh is the positive
    side of a component with `mirrors`, `images` (copies - 1, elements) contains the piece (index) to which each mirror image of an element
    belongs.
    """

    mesh: ngsolve.Mesh
    media: tuple[Medium, ...]
    faces: tuple[str, ...]
    owner: Array
    finer: Array
    mirrors: Mirrors = Mirrors()
    images: tuple[Array, ...] = ()


def mesh_component(
    component: Component, fineness: Fineness, report: Report = silent, first: int = 0, *, by_symmetry: bool = False
) -> PieceMesh:
    """Draw and mesh a component; if `by_symmetry`, mesh only the positive side of a symmetric component.

    Elements near the ends of arcs get straight sides if curved sides would invert the elements. If the mesher fails, or an element of a
    neck is inverted, a few other sizes and gradings are tried. `first` is the number of the first attempt, if earlier attempts crashed.
    Drawings and meshes are cached: for another order, only the sides of the cached mesh are curved again. Raises `DesignError` if meshing
    fails in all attempts.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> whole = mesh_component(bar(), Fineness(order=2))
    >>> round(ngsolve.Integrate(1, whole.mesh), 6), whole.faces  # mm^3
    (10000.0, ('end', 'foot'))
    """
    require(thin_findings(component.pieces, fineness))
    report(Stage.DRAWING, 0.0)
    subject = _Subject.of(component, by_symmetry=by_symmetry)
    drawing = _drawing(subject)
    failure = "the mesher did not run"
    for number in range(first, len(ATTEMPTS)):
        report(Stage.MESHING, number / len(ATTEMPTS))
        outcome = _straight_mesh(subject, replace(fineness, order=1), number)
        result = outcome if isinstance(outcome, str) else _finish(component.pieces, drawing, _curve(outcome, fineness.order))
        if isinstance(result, PieceMesh):
            return result
        failure = result
    raise _refuse_mesh(component, failure)


@dataclass(frozen=True)
class _Subject:
    """A component, identified by the inputs of its mesh: its content and the names of its faces."""

    content: str
    faces: tuple[str, ...]
    by_symmetry: bool
    component: Component = field(compare=False)

    @staticmethod
    def of(component: Component, *, by_symmetry: bool) -> _Subject:
        joints = [*(item.joint for item in component.interfaces), *component.fixed]
        return _Subject(content(component), tuple(joint.name for joint in joints), by_symmetry, component)


@SESSION.keep(_AT_HAND)
def _drawing(subject: _Subject) -> Cad:
    whole = cad(subject.component)
    return cut_component(subject.component, whole) if subject.by_symmetry else whole


@SESSION.keep(_AT_HAND)
def _straight_mesh(subject: _Subject, fineness: Fineness, number: int) -> ngsolve.Mesh | str:
    """An attempt at a mesh, without curving; else the reason of the failure."""
    component, drawing = subject.component, _drawing(subject)
    shrink, grading, curvature = ATTEMPTS[number]
    sizes = {
        "mp": _refine_necks(component.pieces, shrink * fineness.neck, drawing.mirrors),
        "maxh": _set_sizes(component, drawing, fineness, shrink),
        "grading": grading * fineness.grading,
        "curvaturesafety": curvature * _CURVATURE,
    }
    return generate_mesh(drawing.shape, sizes)


def _curve(straight: ngsolve.Mesh, order: int) -> ngsolve.Mesh:
    """A copy of a mesh, curved to its drawing."""
    mesh = ngsolve.Mesh(straight.ngmesh.Copy())
    mesh.Curve(order)
    return mesh


def generate_mesh(shape: occ.TopoDS_Shape, sizes: Mapping[str, Any]) -> ngsolve.Mesh | str:
    """Generate a mesh [mm] of a drawing with mesher options `sizes`; if meshing fails, return the reason.

    The mesher uses one thread: with several threads, meshes may differ from run to run, and threads mostly wait for one another.

    >>> generate_mesh(occ.Box(occ.Pnt(0, 0, 0), occ.Pnt(1, 1, 1)), {"maxh": 2.0}).ne > 0
    True
    """
    try:
        raw = occ.OCCGeometry(shape).GenerateMesh(**sizes, parallel_meshing=False)
    except Exception as error:  # noqa: BLE001 (netgen raises a bare NgException, and others for CAD it cannot read)
        return str(error)
    mesh = ngsolve.Mesh(raw)
    return mesh if mesh.ne else "no elements"


def _finish(pieces: tuple[Piece, ...], drawing: Cad, mesh: ngsolve.Mesh) -> PieceMesh | str:
    """A mesh without folded elements, those of necks curved; else the problem."""
    places = centroids(mesh)
    owner = owners(pieces, places)
    necks = np.zeros(len(places), dtype=bool)
    for number, piece in enumerate(pieces):
        if piece.body is None:
            within = np.abs((places - piece.frame.position) @ piece.frame.rotation[:, 0]) < _NECK * half_extents(piece)[0]
            necks |= within & (owner == number)
    finer = np.isin(owner, [number for number, piece in enumerate(pieces) if is_notch(piece.form) or is_thin(piece.form)])
    images = tuple(owners(pieces, places * signs) for signs in drawing.mirrors.images)
    return straighten(mesh, necks) or PieceMesh(mesh, drawing.media, drawing.faces, owner, finer, drawing.mirrors, images)


def _refine_necks(pieces: tuple[Piece, ...], neck: float, mirrors: Mirrors) -> MeshingParameters:
    """Smaller elements at the largest strain gradients of hinges."""
    return restrict_sizes(
        (mirrors.within(points @ piece.frame.rotation.T + piece.frame.position), size)
        for piece in pieces
        if isinstance(piece.form, Shaped)
        for points, size in _fine_points(piece.form, neck)
    )


def restrict_sizes(places: Iterable[tuple[Array, float]]) -> MeshingParameters:
    """Limit the element size at points (n, 3) [m].

    >>> restrict_sizes([(np.zeros((1, 3)), 1e-3)]) is not None
    True
    """
    result = MeshingParameters()
    for points, size in places:
        for x, y, z in (points * MILLIMETRES).tolist():
            result.RestrictH(x, y, z, h=size * MILLIMETRES)
    return result


def _fine_points(form: Shaped, neck: float) -> Iterator[tuple[Array, float]]:
    """Points (n, 3) of a hinge, in its frame, and the size of elements there [m]."""
    if is_strut(form):
        size = _ROOT * neck * thinnest(form)
        yield _root_points(form, size), size
    if is_leaf(form) and is_thin(form):
        grain = max(thinnest(form), _FINE * float(np.real(form.throat.width)))
        for depth, growth in _BENEATH:
            yield _root_points(form, growth * neck * grain, depth * grain), growth * neck * grain
    if is_notch(form):
        size = middle_size(form, neck)
        yield _middle_points(form, size), size
    yield from core_points(form, _ROUND * neck)


def _middle_points(form: Shaped, size: float) -> Array:
    """Points (n, 3) in the middle plane of a notch around its thinnest line, in its frame [m]."""
    thickness, width = (float(np.real(value)) for value in (form.throat.height, form.throat.width))
    reach = _REACH * np.sqrt(0.5 * span(form) * thickness)
    along, across = (np.linspace(-half, half, 1 + int(np.ceil(2.0 * half / size))) for half in (reach, 0.5 * width))
    return np.array([(x, 0.0, z) for x in along for z in across])


def core_points(form: Shaped, neck: float) -> Iterator[tuple[Array, float]]:
    """Yield points (n, 3) inside a round neck with an arc, in the neck's frame, and the element size at the points [m].

    `neck` is the element size on the neck's faces, divided by the thickness. The points are on the neck's axis and halfway to its surface.
    Other hinges have no points.

    >>> from flexstage.parts.leaf import Leaf
    >>> list(core_points(Leaf("steel", 0.01, 1e-3, 5e-3), 1.5))
    []
    """
    if not (form.has_arc and form.is_axisymmetric):
        return
    size = _CORE * neck * thinnest(form)
    stations, sections = zip(*form.silhouette, strict=True)
    place = 0.0
    while place < _HELD * stations[-1]:
        own = size + _AWAY * place
        radius = 0.25 * float(np.interp(place, stations, [section.height for section in sections]))
        turns = 2.0 * np.pi * np.linspace(0.0, 1.0, int(np.ceil(2.0 * np.pi * radius / own)), endpoint=False)
        circle = np.stack([np.full_like(turns, place), radius * np.cos(turns), radius * np.sin(turns)], axis=1)
        both = np.vstack([circle, [(place, 0.0, 0.0)]])
        yield np.vstack([both, both * (-1.0, 1.0, 1.0)]), own
        place += 0.5 * own


def _root_points(form: Shaped, size: float, depth: float = 0.0) -> Array:
    """Points (n, 3) along the edges of both end faces of a hinge, or at a depth behind them, in its frame [m]."""
    half, high, wide = (0.5 * float(np.real(value)) for value in (form.span, form.end.height, form.end.width))
    along = np.linspace(-1.0, 1.0, 1 + int(np.ceil(2.0 * max(high, wide) / size)))
    one = np.ones_like(along)
    edges = [(along, one), (along, -one), (one, along), (-one, along)]
    if form.is_axisymmetric:
        edges = [(np.cos(np.pi * along), np.sin(np.pi * along))]
    across, ends = np.hstack(edges), (-half - depth, half + depth)
    return np.vstack([np.stack([np.full_like(across[0], end), high * across[0], wide * across[1]], axis=1) for end in ends])


def _set_sizes(component: Component, drawing: Cad, fineness: Fineness, shrink: float) -> float:
    """Set the faces' mesh sizes; return the largest size anywhere [mm]."""
    sizes = [shrink * (element_size(piece, fineness) * MILLIMETRES) for piece in component.pieces]
    scale = _PRINT * fineness.neck * shrink * MILLIMETRES
    prints = {item.joint.name: scale * item.joint.area**0.5 for item in component.interfaces if item.footprint}
    for face in drawing.shape.faces:
        own = min(_near(component.pieces, sizes, face), default=max(sizes))
        face.maxh = min(own, prints.get(face.name or "", own))
    return max(sizes)


def _near(pieces: tuple[Piece, ...], sizes: list[float], face: occ.Face) -> list[float]:
    """Sizes of the pieces of a face: links that contain it entirely, bodies that contain its centre."""
    centre = coordinates(face.center)[None] / MILLIMETRES
    corners = np.array([coordinates(vertex.p) for vertex in face.vertices]).reshape(-1, 3) / MILLIMETRES
    return [
        size * _thicker(piece, centre)
        for piece, size in zip(pieces, sizes, strict=True)
        # A wall of a block around the end of a hinge has its centre on the hinge.
        if region(piece, centre)[0] <= _WITHIN and (piece.body is not None or np.all(region(piece, corners) <= _WITHIN))
    ]


def _thicker(piece: Piece, centre: Array) -> float:
    """Thickness of a leaf in pieces at a point (1, 3) [m], over that at its throat; 1 for other forms."""
    if not isinstance(piece.form, Shaped) or piece.form.is_prismatic or not piece.form.slender:
        return 1.0
    stations, sections = zip(*piece.form.silhouette, strict=True)
    place = float(((centre - piece.frame.position) @ piece.frame.rotation)[0, 0])
    return float(np.interp(place, stations, [section.thinnest for section in sections])) / thinnest(piece.form)


def _refuse_mesh(component: Component, reason: str) -> Exception:
    thin = min(component.pieces, key=lambda piece: thinnest(piece.form))
    return refuse(
        component.name,
        f"no mesh could be made ({reason}); its thinnest piece is {thin.name}, {thinnest(thin.form) * MILLIMETRES:.4g} mm thick",
        "Use a finer mesh, or remove steps and slivers between outlines that are much smaller than the neck",
    )


def centroids(mesh: ngsolve.Mesh) -> Array:
    """Compute the mean vertex positions (n, 3) of all elements [m].

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> found = centroids(mesh_component(bar(), Fineness(order=2)).mesh)
    >>> bool(np.all((0.0 < found[:, 0]) & (found[:, 0] < 0.1)))
    True
    """
    corners = np.array([vertex.point for vertex in mesh.vertices])
    members = np.array([[vertex.nr for vertex in element.vertices] for element in mesh.Elements(ngsolve.VOL)])
    return corners[members].mean(axis=1) / MILLIMETRES


def owners(pieces: tuple[Piece, ...], points: Array) -> Array:
    """Return for each point the index of the piece with the nearest bounding box. At equal distance, a link has priority over a body.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> owners(bar().pieces, np.array([[0.05, 0.0, 0.0]])).tolist()
    [0]
    """
    away = np.stack([region(piece, points) - (1e-9 if piece.body is None else 0.0) for piece in pieces])
    return np.argmin(away, axis=0)
