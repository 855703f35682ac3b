"""All pieces of a stage in its frame, before it is cut into components."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from flexstage.base.finding import refuse
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.geometry.outline import Outline, outlines
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.parts.piezo import Piezo
from flexstage.solid.fea.geometry.piece import Piece, body_pieces, link_forms, link_pieces
from flexstage.solid.fea.solver.component import Joint, link_joints


@dataclass(frozen=True, eq=False)
class Stage:
    """The pieces of a stage by address, in the axes of the stage; pieces of the ground have the `body` "ground".

    `boxes` contains the outlines of the pieces, `joints` the two ends of every link, `materials` the name of each piece's material. For a
    stack, `materials` contains the name of its part instead.
    """

    assembly: Assembly
    pieces: Mapping[str, Piece]
    boxes: Mapping[str, Outline]
    joints: Mapping[str, tuple[Joint, Joint]]
    materials: Mapping[str, str]
    bodies: Mapping[str, tuple[Piece, ...]] = field(init=False)

    def __post_init__(self) -> None:
        found: dict[str, tuple[Piece, ...]] = {}
        for piece in self.pieces.values():
            if piece.body is not None:
                found[piece.body] = (*found.get(piece.body, ()), piece)
        object.__setattr__(self, "bodies", found)


def stage_pieces(mechanism: Mechanism) -> Stage:
    """Return the pieces of a stage. Parts with a specified stiffness instead of a shape have no piece.

    Raises `DesignError` with the names of links that have neither a shape nor a specified stiffness.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = stage_pieces(double_triangle())
    >>> len(stage.joints), stage.materials["B1/front"], stage.pieces["B1/lug.nose"].body
    (27, 'steel', 'platform')
    """
    assembly = expand(mechanism)
    forms, owned = link_forms(assembly), {**{name: body.solids for name, body in assembly.bodies.items()}, GROUND: assembly.ground}
    found = [
        *(piece for body, solids in owned.items() for piece in body_pieces(body, solids, mechanism.materials)),
        *link_pieces(assembly, forms),
    ]
    pieces = {piece.name: piece for piece in found}
    materials = {
        name: assembly.links[name].link.part if isinstance(piece.form, Piezo) else piece.form.material for name, piece in pieces.items()
    }
    joints = {name: link_joints(assembly.links[name], form) for name, form in forms.items()}
    return Stage(assembly, pieces, {outline.name: outline for outline in outlines(assembly)}, joints, materials)


def require_shapes(mechanism: Mechanism, stage: Stage) -> None:
    """Raise a `DesignError` for a stage without any shape.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> require_shapes(parallelogram(), stage_pieces(parallelogram()))
    """
    if not stage.pieces:
        advice = "Add solids to bodies, or use parts with a shape"
        raise refuse(mechanism.name or "stage", "no body has outlines, and no link has a shape", advice)
