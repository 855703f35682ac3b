"""Meshes: tetrahedra graded to the thickness of each neck, curved to the drawn geometry."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import ngsolve
import numpy as np
from netgen import occ

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Straight
from flexstage.readings.solid.cad import Cad, cad, region
from flexstage.readings.solid.component import Component
from flexstage.readings.solid.draw import MILLIMETRES
from flexstage.readings.solid.fineness import ATTEMPTS, Fineness
from flexstage.readings.solid.piece import Medium, Piece, thinnest
from flexstage.readings.solid.progress import Report, Stage, silent

_HINGE_CURVATURE = 3.0
_ROUND_CURVATURE = 1.5
_WITHIN = 1e-6
"""A face belongs to a piece when its centre is this near its bounding box [m]."""


@dataclass(frozen=True)
class Meshed:
    """A component's mesh [mm], its media by name `medium 0`, ..., named faces, and the piece (index) each element belongs to."""

    mesh: ngsolve.Mesh
    media: tuple[Medium, ...]
    faces: tuple[str, ...]
    owner: Array


def meshed(component: Component, fineness: Fineness, report: Report = silent, first: int = 0) -> Meshed:
    """Draw and mesh a component.

    Where the mesher fails, or a curved face turns an element inside out, all sizes are shrunk and it is tried again, a few times; `first`
    is the attempt to begin with, where an earlier one took the process down. Raises `DesignError` when none of that helps.
    """
    report(Stage.DRAWING, 0.0)
    drawing = cad(component)
    failure = "the mesher was not asked"
    for number, (shrink, grading, curvature) in enumerate(ATTEMPTS[first:], start=first):
        report(Stage.MESHING, number / len(ATTEMPTS))
        largest = _sized(component, drawing, fineness, shrink)
        outcome = _attempted(
            drawing,
            fineness.order,
            {"maxh": largest, "grading": grading * fineness.grading, "curvaturesafety": curvature * _curvature(component)},
        )
        if isinstance(outcome, ngsolve.Mesh):
            return Meshed(outcome, drawing.media, drawing.faces, owners(component.pieces, centroids(outcome)))
        failure = outcome
    raise _unmeshed(component, failure)


def _attempted(drawing: Cad, order: int, sizes: Mapping[str, float]) -> ngsolve.Mesh | str:
    """One attempt; else what went wrong."""
    try:
        raw = occ.OCCGeometry(drawing.shape).GenerateMesh(**sizes)
    except Exception as error:  # noqa: BLE001 (netgen raises a bare NgException, and others for CAD it cannot read)
        return str(error)
    mesh = ngsolve.Mesh(raw)
    if mesh.ne == 0:
        return "no elements came out"
    mesh.Curve(order)
    lowest = _lowest_jacobian(mesh)
    return mesh if lowest > 0.0 else f"a curved face turns an element inside out, Jacobian {lowest:.3g}"


def _curvature(component: Component) -> float:
    """Segments per radius: the arcs of hinges fold elements that are too coarse; stacks and discs do not."""
    hinged = any(isinstance(piece.form, (Notch, Neck)) and not isinstance(piece.form.profile, Straight) for piece in component.pieces)
    return _HINGE_CURVATURE if hinged else _ROUND_CURVATURE


def _sized(component: Component, drawing: Cad, fineness: Fineness, shrink: float) -> float:
    """Set the faces' mesh sizes; return the largest size anywhere [mm]."""
    sizes = [shrink * _size(piece, fineness) for piece in component.pieces]
    for face in drawing.shape.faces:
        centre = np.array([[face.center.x, face.center.y, face.center.z]]) / MILLIMETRES
        near = [size for piece, size in zip(component.pieces, sizes, strict=True) if region(piece, centre)[0] <= _WITHIN]
        if near:
            face.maxh = min(near)
    return max(sizes)


def _size(piece: Piece, fineness: Fineness) -> float:
    factor = fineness.neck if piece.body is None else fineness.block
    return factor * thinnest(piece.form) * MILLIMETRES


def _unmeshed(component: Component, reason: str) -> Exception:
    thin = min(component.pieces, key=lambda piece: thinnest(piece.form))
    return refuse(
        component.name,
        f"no mesh could be made ({reason}); its thinnest piece is {thin.name} with {thinnest(thin.form) * MILLIMETRES:.4g} mm",
        "Ask for a finer mesh, or look for steps and slivers between outlines that are much smaller than the neck",
    )


def _lowest_jacobian(mesh: ngsolve.Mesh) -> float:
    """The lowest Jacobian determinant at the points of a rule of order four."""
    points = mesh.MapToAllElements(ngsolve.IntegrationRule(ngsolve.TET, 4), ngsolve.VOL)
    return float(np.min(ngsolve.Det(ngsolve.specialcf.JacobianMatrix(3))(points)))


def centroids(mesh: ngsolve.Mesh) -> Array:
    """Vertex means of all elements (n, 3) [m]."""
    corners = np.array([vertex.point for vertex in mesh.vertices])
    members = np.array([[vertex.nr for vertex in element.vertices] for element in mesh.Elements(ngsolve.VOL)])
    return corners[members].mean(axis=1) / MILLIMETRES


def owners(pieces: tuple[Piece, ...], points: Array) -> Array:
    """The piece (index) each point belongs to: the nearest by bounding box, links before bodies where both hold it."""
    away = np.stack([region(piece, points) - (1e-9 if piece.body is None else 0.0) for piece in pieces])
    return np.argmin(away, axis=0)
