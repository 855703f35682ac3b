"""Clearance between outlines without a joint."""

from __future__ import annotations

from collections.abc import Iterator

from flexstage.mechanism.geometry.near import near_pairs
from flexstage.mechanism.mechanism import GROUND
from flexstage.solid.fea.geometry.draw import draw_form, draw_piece
from flexstage.solid.fea.geometry.near import Answer, Question, distance_text, piece_key
from flexstage.solid.fea.geometry.piece import MILLIMETRES, Piece, coordinates, form_digest
from flexstage.solid.fea.geometry.stage_pieces import Stage

TOUCHING = 1e-6
"""Largest distance [m] at which outlines count as touching."""
_NO_VOLUME = 1e-6
"""Largest common volume [mm^3] that is attributed to rounding."""


def clearance_questions(stage: Stage, clearance: float) -> Iterator[Question]:
    """Yield a question for every pair of near outlines of different bodies or links, except pairs of a link and a body that it joins.

    `clearance` is the required distance [m]. Equal pairs of outlines in several instances share one question.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.solid.fea.geometry.stage_pieces import stage_pieces
    >>> stage = stage_pieces(parallelogram())
    >>> len(list(clearance_questions(stage, 0.0))), len(list(clearance_questions(stage, 1.0))) > 20
    (0, True)
    """
    pieces = list(stage.pieces.values())
    for one, other in near_pairs([stage.boxes[piece.name] for piece in pieces], clearance + TOUCHING):
        first, second = pieces[one], pieces[other]
        if _belong_together(stage, first, second):
            continue
        key = f"pair {form_digest(first.form)} {piece_key(second.within(first.frame))}"
        yield Question(key, first.name, lambda pair=(first, second), clearance=clearance: _answers(*pair, clearance))


def _belong_together(stage: Stage, first: Piece, second: Piece) -> bool:
    """Whether two pieces are of one body, or a link and a body it joins."""
    if first.body is not None and second.body is not None:
        return first.body == second.body
    for link, piece in ((first, second), (second, first)):
        if link.body is None and piece.body is not None:
            return piece.body in stage.assembly.links[link.name].joins
    return False


def _answers(first: Piece, second: Piece, clearance: float) -> Iterator[Answer]:
    here, there = draw_form(first.form), draw_piece(second.within(first.frame))
    away, common = float(here.Distance(there)), here * there  # a solid inside another one has a distance to its faces
    if common.mass > _NO_VOLUME:
        at = first.frame.point(coordinates(common.center) / MILLIMETRES) * MILLIMETRES
        place = ", ".join(f"{round(float(value), 3) + 0.0:g}" for value in at)
        yield f"it overlaps {second.name} by {common.mass:.3g} mm3 around ({place}) mm", _advice(first, second)
    elif away > (clearance + TOUCHING) * MILLIMETRES:
        return
    elif away <= TOUCHING * MILLIMETRES:
        yield f"it touches {second.name}, but no joint connects them", _advice(first, second)
    else:
        required = distance_text(clearance * MILLIMETRES)
        yield f"it is {distance_text(away)} from {second.name}, less than the clearance of {required}", _advice(first, second)


def _advice(first: Piece, second: Piece) -> str:
    if GROUND in {first.body, second.body}:
        return "Trim one of the two outlines"
    return "Trim or move one of the two outlines without moving an axis"
