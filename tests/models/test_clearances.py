"""The clearances that decision 0008 lists for the shipped stage, measured between its CAD solids."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest

from flexstage.cases.double_triangle import double_triangle
from flexstage.mechanism.geometry.near import near_pairs
from flexstage.solid.fea.geometry.draw import draw_form, move_solid
from flexstage.solid.fea.geometry.piece import Piece
from flexstage.solid.fea.geometry.stage_pieces import Stage, stage_pieces
from tests.hygiene.source import ROOT

RECORD = ROOT / "docs" / "decisions" / "0008-buildable-solid.md"
NEAR = 9.6e-3
CASING = 25e-3

ROWS: dict[str, tuple[tuple[str, str], ...]] = {
    "lever and pole of one unit": (("vertical lever", "vertical pole"),),
    "front adapter of a vertical unit and its lever": (("vertical lever", "vertical tip"),),
    "adapter of an inner unit and a pole": (("horizontal base", "vertical pole"), ("horizontal tip", "vertical pole")),
    "adapters of inner units and the plate": (("horizontal base", "plate"), ("horizontal tip", "plate")),
    "adapter of an inner unit and a lever": (("horizontal base", "vertical lever"), ("horizontal tip", "vertical lever")),
    "stack (16 mm) and its pole; casing (25 mm)": (("vertical pole", "vertical pzt"),),
    "lug of an inner unit and a pole": (("lug", "vertical pole"),),
}


def kind(piece: Piece) -> str:
    """What a piece is, whichever copy it is of: `vertical lever`, `plate`, `lug`."""
    if piece.body == "platform":
        return piece.name.rpartition("/")[2].partition(".")[0] if "/" in piece.name else "plate"
    unit, _, own = (piece.body or piece.name).partition("/")
    return f"{'horizontal' if unit in ('B1', 'B2', 'B3') else 'vertical'} {own}"


def apart(stage: Stage) -> Iterator[tuple[Piece, Piece]]:
    """Near pairs of outlines that no joint connects."""
    pieces = list(stage.pieces.values())
    for first, second in near_pairs([stage.boxes[piece.name] for piece in pieces], NEAR):
        bodies = [
            set(stage.assembly.links[piece.name].joins) if piece.body is None else {piece.body} for piece in (pieces[first], pieces[second])
        ]
        links = pieces[first].body is None and pieces[second].body is None
        if links or not bodies[0] & bodies[1]:
            yield pieces[first], pieces[second]


@pytest.fixture(scope="module")
def found() -> dict[tuple[str, str], float]:
    """Least distance [mm] of any two kinds."""
    least: dict[tuple[str, str], float] = {}
    for first, second in apart(stage_pieces(double_triangle())):
        shapes = [move_solid(draw_form(piece.form), piece.frame) for piece in (first, second)]
        one, other = sorted((kind(first), kind(second)))
        least[one, other] = min(least.get((one, other), NEAR * 1e3), float(shapes[0].Distance(shapes[1])))
    return least


def listed() -> dict[str, list[float]]:
    """The rows of the record's table: numbers [mm] by what they are between."""
    table = RECORD.read_text(encoding="utf-8").partition("| between | mm |")[2].partition("\n\n")[0]
    rows = re.findall(r"^\| (.+?) \| (.+?) \|$", table, re.MULTILINE)
    return {name: [float(each) for each in re.findall(r"\d+\.?\d*", numbers)] for name, numbers in rows}


def test_the_record_says_what_is_measured(found: dict[tuple[str, str], float]) -> None:
    """Every row to its two digits, and nothing else nearer than its last row says."""
    said = listed()
    *_, (rest, (least,)) = said.items()
    assert rest == "anything else"
    assert set(ROWS) | {rest} == set(said)
    for name, kinds in ROWS.items():
        assert min(found[pair] for pair in kinds if pair in found) == pytest.approx(said[name][0], abs=0.005), name
    others = {pair: distance for pair, distance in found.items() if pair not in {each for kinds in ROWS.values() for each in kinds}}
    assert min(others.values()) > least


def test_the_casing_passes_the_pole() -> None:
    """The wider casing of the vertical stack takes half of what it is wider from the stack's clearance."""
    stack, casing = listed()["stack (16 mm) and its pole; casing (25 mm)"]
    assert stack - casing == pytest.approx(0.5e3 * (CASING - 0.016))
