"""Geometric tests of near outlines by CAD; each test is evaluated once for all instances."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding
from flexstage.solid.fea.geometry.piece import Piece, form_digest

Answer = tuple[str, str]
"""Description of a problem, and advice."""


@dataclass(frozen=True, eq=False)
class Question:
    """A geometric test of the item `where`: the function `ask` returns the errors. Questions with the same `key` are evaluated once."""

    key: str
    where: str
    ask: Callable[[], Iterable[Answer]]


def findings_of(questions: Iterable[Question]) -> Iterator[Finding]:
    """Evaluate each distinct question once. Report the errors of a question at its first location, with the names of its other locations.

    >>> asked = [Question("a", name, lambda: [("it is loose", "Hold it")]) for name in ("B1/front", "B2/front")]
    >>> [str(finding) for finding in findings_of(asked)]
    ['B1/front: it is loose (also B2/front). Hold it.']
    """
    same: dict[str, list[Question]] = {}
    for question in questions:
        same.setdefault(question.key, []).append(question)
    for first, *others in same.values():
        alike = f" (also {', '.join(other.where for other in others)})" if others else ""
        for what, advice in first.ask():
            yield Finding(first.where, f"{what}{alike}", advice)


def piece_key(piece: Piece) -> str:
    """Format the form and the frame of a piece as a string, equal for frames that differ only by rounding error.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.spatial.frame import Frame
    >>> (own,) = bar().pieces
    >>> piece_key(own) == piece_key(own.within(Frame(np.eye(3), np.full(3, 1e-13))))
    True
    """
    numbers = np.round(np.concatenate([np.ravel(piece.frame.rotation), piece.frame.position]), 9) + 0.0
    return f"{form_digest(piece.form)} {numbers.tolist()}"


def distance_text(millimetres: float) -> str:
    """Format a length [mm] as text; lengths below a millimetre are in um.

    >>> distance_text(0.012), distance_text(2.5)
    ('12 um', '2.5 mm')
    """
    return f"{1e3 * millimetres:.3g} um" if millimetres < 1.0 else f"{millimetres:.4g} mm"
