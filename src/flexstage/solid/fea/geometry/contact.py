"""Contact checks: links must meet their bodies, each body must form one solid, and there must be clearance between all other outlines.

All checks are made together before meshing; lengths within this file are in mm, as in CAD.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from netgen import occ

from flexstage.base.finding import DesignError, Finding
from flexstage.mechanism.geometry.near import near_pairs
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.solid.fea.geometry.clearance import clearance_questions
from flexstage.solid.fea.geometry.draw import draw_form, draw_piece, unite
from flexstage.solid.fea.geometry.imported import import_findings
from flexstage.solid.fea.geometry.near import Answer, Question, distance_text, findings_of, piece_key
from flexstage.solid.fea.geometry.piece import MILLIMETRES, Piece, form_digest, span, thinnest
from flexstage.solid.fea.geometry.sliver import SLIVER, sliver_findings
from flexstage.solid.fea.geometry.stage_pieces import Stage, stage_pieces
from flexstage.solid.fea.solver.component import components

_DEPTH = 0.01
"""Depth [mm] to which an end face is extruded for the contact test."""
_GAP = 1e-5
_SHARE = 1e-3
_NEAR = 2e-3
"""Largest distance between a link and a piece of its body for a contact test [m]."""


def contact_findings(mechanism: Mechanism, clearance: float = 0.0) -> tuple[Finding, ...]:
    """Return the errors that prevent the outlines of a stage from forming the described solids; empty for a sound stage.

    If a link has a shape, each of its end faces must be entirely on the outline of a body that the link joins. Bodies without outlines are
    not checked. Outlines of the ground are checked only for links in the same unit. Outlines of one body must be joined over faces and form
    one solid. All other outlines must be farther apart than `clearance` [m]; a distance up to 1 um counts as contact and is an error. No
    step, gap, edge or face may be much smaller than the local geometry.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> contact_findings(parallelogram())
    ()
    """
    try:
        stage = stage_pieces(mechanism)
    except DesignError as error:
        return error.findings
    if foreign := import_findings(mechanism):
        return foreign
    questions = [*_joint_questions(stage), *_body_questions(stage), *clearance_questions(stage, clearance)]
    found = tuple(findings_of(questions))
    return (*found, *sliver_findings(components(mechanism), coarse=bool(found)))


def _joint_questions(stage: Stage) -> Iterator[Question]:
    for name in stage.joints:
        ends = tuple(_end(stage, name, number) for number in (0, 1))
        piece = stage.pieces[name]
        yield Question(
            f"joint {form_digest(piece.form)} {' '.join(' '.join((str(end.side), *map(piece_key, end.pieces))) for end in ends)}",
            name,
            lambda piece=piece, ends=ends: _link_answers(piece, ends[0], ends[1]),
        )


@dataclass(frozen=True, eq=False)
class _End:
    """An end of a link: towards +x of it (`side` 1) or -x, and the pieces of its body near the link, in the link's frame."""

    side: float
    body: str
    pieces: tuple[Piece, ...]


@dataclass(frozen=True)
class _Meeting:
    """Contact of an end face with an outline: the gap, the share of the face in contact, the depth of penetration."""

    gap: float
    share: float
    depth: float

    @property
    def sound(self) -> bool:
        return self.gap <= _GAP and self.share >= 1.0 - _SHARE and self.depth == 0.0


def _end(stage: Stage, link: str, number: int) -> _End:
    joint, piece = stage.joints[link][number], stage.pieces[link]
    pieces = [each for each in stage.bodies.get(joint.body, ()) if joint.body != GROUND or _group(each.name) == _group(link)]
    boxes = [stage.boxes[link], *(stage.boxes[each.name] for each in pieces)]
    near = [pieces[other - 1] for one, other in near_pairs(boxes, _NEAR) if one == 0]
    return _End(1.0 if number else -1.0, joint.body, tuple(each.within(piece.frame) for each in near or pieces))


def _group(name: str) -> str:
    return name.rpartition("/")[0]


def _link_answers(piece: Piece, first: _End, second: _End) -> Iterator[Answer]:
    shape, half = draw_form(piece.form), 0.5 * span(piece.form) * MILLIMETRES
    solids = [(end, unite(end.pieces)) for end in (first, second) if end.pieces]
    met = [(end, solid, _meeting(shape, half, end.side, solid)) for end, solid in solids]
    if not all(meeting.sound for *_, meeting in met) and all(_meeting(shape, half, -end.side, solid).sound for end, solid in solids):
        yield (
            f"it is drawn from {second.body} to {first.body}, but joins {first.body} to {second.body}",
            "Reverse `along`, or exchange the two bodies",
        )
        return
    for end, solid, meeting in met:
        yield from _end_answers(end, meeting)
        if meeting.sound:
            yield from _side_answers(shape, half, end, solid)


def _meeting(shape: occ.TopoDS_Shape, half: float, side: float, solid: occ.TopoDS_Shape) -> _Meeting:
    faces = [face for face in shape.faces if _is_end(face, side * half)]
    area = sum(face.mass for face in faces)
    gap = min(float(face.Distance(solid)) for face in faces)
    outward, inward = (sum((face.Extrude(occ.Vec(sign * side * _DEPTH, 0, 0)) * solid).mass for face in faces) for sign in (1.0, -1.0))
    if gap > _GAP and inward <= _SHARE * area * _DEPTH:  # a face inside the solid has a distance to its faces
        return _Meeting(gap, 0.0, 0.0)
    gap = min(gap, _GAP)
    depth = 0.0
    if inward > _SHARE * area * _DEPTH:
        low, high = (shape * solid).bounding_box
        depth = half - low.x if side > 0.0 else half + high.x
    return _Meeting(gap, float(outward / (area * _DEPTH)), float(depth))


def _is_end(face: occ.Face, at: float) -> bool:
    return abs(face.center.x - at) < 1e-6 and all(abs(vertex.p.x - at) < 1e-6 for vertex in face.vertices)


def _end_answers(end: _End, meeting: _Meeting) -> Iterator[Answer]:
    if meeting.gap > _GAP:
        away = distance_text(meeting.gap)
        yield f"its end face is {away} away from {end.body}", f"Move or lengthen an outline by {away} so that they touch"
        return
    if meeting.depth > 0.0:
        deep = distance_text(meeting.depth)
        yield (
            f"it runs {deep} into {end.body}",
            f"Trim the outline of {end.body} by {deep}, or move it: end faces must touch without overlap",
        )
    if meeting.share < 1.0 - _SHARE:
        yield (
            f"only {100.0 * meeting.share:.3g} % of its end face is on {end.body}",
            f"Widen or move the outline of {end.body}: it must support the whole end face",
        )


def _side_answers(shape: occ.TopoDS_Shape, half: float, end: _End, solid: occ.TopoDS_Shape) -> Iterator[Answer]:
    """Check that a link meets its body only at the end face."""
    margin, far = min(0.05, 0.05 * half), 1e3 * half
    inner = shape * occ.Box(occ.Pnt(-half + margin, -far, -far), occ.Pnt(half - margin, far, far))
    if inner.Distance(solid) < 0.5 * margin:
        yield f"it also meets {end.body} outside its end face", f"Trim the outline of {end.body} next to the link"


def _body_questions(stage: Stage) -> Iterator[Question]:
    for body, pieces in stage.bodies.items():
        if body != GROUND and len(pieces) > 1:
            seen = [piece.within(pieces[0].frame) for piece in pieces]
            slot = SLIVER * max(thinnest(piece.form) for piece in pieces)
            near = near_pairs([stage.boxes[piece.name] for piece in pieces], slot)
            yield Question(f"body {' '.join(map(piece_key, seen))}", body, lambda seen=seen, near=near: _body_answers(seen, near))


def _body_answers(pieces: Sequence[Piece], near: Sequence[tuple[int, int]]) -> Iterator[Answer]:
    shapes = [draw_piece(piece) for piece in pieces]
    if len(occ.Fuse(shapes).solids) == 1:
        yield from _slot_answers(pieces, shapes, near)
    else:
        yield from _gap_answers(pieces, shapes)


def _slot_answers(pieces: Sequence[Piece], shapes: Sequence[occ.TopoDS_Shape], near: Sequence[tuple[int, int]]) -> Iterator[Answer]:
    """Slots between outlines that are joined elsewhere."""
    thin = [thinnest(piece.form) for piece in pieces]
    for one, other in near:
        away = float(shapes[one].Distance(shapes[other]))
        if _GAP < away < SLIVER * min(thin[one], thin[other]) * MILLIMETRES:
            what = f"a slot of {distance_text(away)} is left between {pieces[one].name} and {pieces[other].name}"
            yield what, "Close the slot, or widen it: its width sets the size of elements"


def _gap_answers(pieces: Sequence[Piece], shapes: Sequence[occ.TopoDS_Shape]) -> Iterator[Answer]:
    """Groups of outlines without a common face with the others."""
    groups = _connected_groups(shapes)
    for group in groups[1:]:
        rest = [number for number in range(len(shapes)) if number not in group]
        away, one, other = min((float(shapes[i].Distance(shapes[j])), i, j) for i in group for j in rest)
        names = ", ".join(pieces[number].name for number in group)
        if away > _GAP:
            yield f"{names} is {distance_text(away)} away from {pieces[other].name}", "Make the outlines of one body touch over a face"
        else:
            what = f"{names} meets {pieces[other].name} along an edge or at a point only ({pieces[one].name})"
            yield what, "Make the outlines touch over a face, or overlap"


def _connected_groups(shapes: Sequence[occ.TopoDS_Shape]) -> list[list[int]]:
    """Groups of shapes joined over faces."""
    groups: list[list[int]] = []
    for number, shape in enumerate(shapes):
        joined = [group for group in groups if any(len((shape + shapes[other]).solids) == 1 for other in group)]
        groups = [group for group in groups if group not in joined]
        groups.append(sorted([number, *(member for group in joined for member in group)]))
    return sorted(groups, key=lambda group: (-len(group), group))
