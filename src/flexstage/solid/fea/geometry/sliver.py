"""Slivers: steps, gaps, edges and faces of a component that are much smaller than the local geometry; they make meshes fail or too fine.

Lengths within this file are in mm, as in CAD.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from netgen import occ

from flexstage.base.finding import DesignError, Finding
from flexstage.base.number import Array
from flexstage.solid.fea.geometry.cad import cad, footprints, half_extents
from flexstage.solid.fea.geometry.draw import draw_form
from flexstage.solid.fea.geometry.near import Question, distance_text, findings_of
from flexstage.solid.fea.geometry.piece import MILLIMETRES, Form, Piece, coordinates, thinnest
from flexstage.solid.fea.jobs.content import content
from flexstage.solid.fea.solver.component import Component

SLIVER = 0.05
"""Largest size of a sliver, divided by the thickness of the thinnest piece at the sliver."""
_OWN = 0.5
"""Largest size of a sliver, divided by the smallest edge or width of the isolated pieces."""
_NOTHING = 1e-7
_TOUCHING = 1e-6
"""Largest distance between a sliver's middle and the box of its piece [m], unless the sliver is larger."""


@dataclass(frozen=True)
class _Sliver:
    """An edge or face: its kind, its size, and its pieces (index)."""

    kind: str
    size: float
    pieces: tuple[int, ...]


def sliver_findings(parts: Sequence[Component], *, coarse: bool = False) -> Iterator[Finding]:
    """Yield the slivers of every distinct component, drawn as one solid.

    `coarse` means that other errors are already known; errors of drawing are then omitted.

    >>> list(sliver_findings([]))
    []
    """
    yield from findings_of(Question(content(part), part.name, lambda part=part: _answers(part, coarse=coarse)) for part in parts)


def _answers(component: Component, *, coarse: bool) -> Iterator[tuple[str, str]]:
    try:
        shape = cad(component).shape
    except DesignError as error:
        if not coarse:
            yield from ((f"{finding.where}: {finding.what}", finding.advice) for finding in error.findings)
        return
    except Exception as error:  # noqa: BLE001 (the CAD kernel raises what it likes)
        if not coarse:
            yield f"its outlines cannot be joined by the CAD kernel ({error})", "Look for faces that nearly coincide"
        return
    pieces = (*component.pieces, *footprints(component))
    smallest: dict[tuple[int, ...], _Sliver] = {}
    for sliver in _slivers(shape, pieces):
        if sliver.pieces not in smallest or sliver.size < smallest[sliver.pieces].size:
            smallest[sliver.pieces] = sliver
    for sliver in smallest.values():
        yield _finding(sliver, pieces)


def _finding(sliver: _Sliver, pieces: Sequence[Piece]) -> tuple[str, str]:
    there = [pieces[number] for number in sliver.pieces]
    thin = min(there, key=lambda piece: thinnest(piece.form))
    names = " and ".join(dict.fromkeys(piece.name for piece in there))
    scale = distance_text(thinnest(thin.form) * MILLIMETRES)
    what = f"{sliver.kind.format(distance_text(sliver.size))} is left at {names}; the thinnest piece there, {thin.name}, is {scale} thick"
    return what, "Make their faces flush, or the step between them larger"


def _slivers(shape: occ.TopoDS_Shape, pieces: Sequence[Piece]) -> Iterator[_Sliver]:
    thin = [thinnest(piece.form) * MILLIMETRES for piece in pieces]
    limit = SLIVER * max(thin)
    measured = [
        *(("an edge {} long", edge.mass, edge) for edge in shape.edges),
        *(("a face {} wide", _width(face), face) for face in shape.faces),
    ]
    small = [(kind, size, coordinates(place.center) / MILLIMETRES) for kind, size, place in measured if _NOTHING < size < limit]
    halves = [half_extents(piece) for piece in pieces] if small else []
    for kind, size, middle in small:
        within = max(_TOUCHING, size / MILLIMETRES)
        there = tuple(number for number, piece in enumerate(pieces) if _away(piece, halves[number], middle) <= within)
        if there and all(size < SLIVER * thin[number] and size < _OWN * _own(pieces[number].form) for number in there):
            yield _Sliver(kind, size, there)


def _away(piece: Piece, half: Array, point: Array) -> float:
    """How far a point is outside a piece's box, by the largest component [m]."""
    local = np.real(piece.frame.rotation).T @ (point - np.real(piece.frame.position))
    return float(np.max(np.abs(local) - half))


def _own(form: Form) -> float:
    """The shortest edge or narrowest face of a form drawn alone."""
    shape = draw_form(form)
    sizes = [*(edge.mass for edge in shape.edges), *(_width(face) for face in shape.faces)]
    return min(size for size in sizes if size > _NOTHING)


def _width(face: occ.Face) -> float:
    """The short side of the rectangle of equal area and rim: a strip's width."""
    area, half_rim = face.mass, 0.5 * sum(edge.mass for edge in face.edges)
    return float(0.5 * (half_rim - np.sqrt(max(half_rim**2 - 4.0 * area, 0.0))))
