"""Content: the inputs of a component's reduction without names, so that equal instances and renamed designs have the same content."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

import numpy as np

from flexstage.base.session import SESSION
from flexstage.solid.fea.geometry.piece import form_digest
from flexstage.solid.fea.solver.component import Component
from flexstage.spatial.frame import Frame

KEPT = 512
"""Number of components whose content is cached in memory."""


@SESSION.keep(KEPT)
def content(component: Component) -> str:
    """Return a digest of a component's geometry, media and joints, in its own axes. All instances of a unit have the same digest.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.solid.fea.solver.component import components
    >>> len({content(part) for part in components(double_triangle())})
    7
    """
    state = hashlib.sha256()
    for piece in _pieces(component):
        state.update(piece.encode())
    return state.hexdigest()


def _pieces(component: Component) -> Iterator[str]:
    bodies = list(component.bodies)
    for piece in component.pieces:
        owner = -1 if piece.body is None else bodies.index(piece.body)
        yield f"piece {form_digest(piece.form)} {piece.medium} {_frame(piece.frame)} {owner};"
    for item in component.interfaces:
        stamp = "" if item.footprint is None else f"{form_digest(item.footprint.form)} {_frame(item.footprint.frame)}"
        yield f"joint {_frame(item.joint.frame)} {stamp} {item.yields};"
    for joint in component.fixed:
        yield f"fixed {_frame(joint.frame)};"
    for at in component.bodies.values():
        yield f"body {_numbers(at)};"
    for end in component.seats:
        yield f"seat {_numbers(end.point)} {bodies.index(end.body)};"


def _frame(frame: Frame) -> str:
    return f"{_numbers(frame.rotation)} {_numbers(frame.position)}"


def _numbers(values: np.ndarray) -> str:
    return (np.round(np.real(values), 10) + 0.0).tobytes().hex()
