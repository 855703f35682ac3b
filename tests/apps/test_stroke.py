"""The command `stroke`: which path it plays, over which points, under which loads."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from flexstage.mechanism.store import dump
from tests.apps.command import Command, design_in
from tests.laws.test_nonlinear import guide

PATHS = """
[paths.out]
drive = "platform.x"
to = ["0 mm", "0.1 mm"]
points = 3
[paths.back]
drive = "platform.x"
to = ["0 mm", "-0.1 mm"]
"""


@pytest.fixture
def two(tmp_path: Path) -> Path:
    """A guide with two paths."""
    design_in(tmp_path, "parallelogram")
    design = tmp_path / "stage.toml"
    design.write_text(design.read_text() + PATHS)
    return tmp_path


def test_the_first_path_is_played_and_the_others_are_told(flexstage: Command, two: Path) -> None:
    ended = flexstage("stroke", "stage.toml", "--json", "first.json")
    assert "Load path: out. To choose another: --path back" in ended.err
    flexstage("stroke", "stage.toml", "--path", "back", "--steps", "2", "--load", "platform.fx=1 N", "--json", "back.json")
    first, back = (json.loads((two / name).read_text())["along"] for name in ("first.json", "back.json"))
    assert [row[0] for row in first["values"]] == pytest.approx([0.0, 0.5e-4, 1e-4])
    assert [row[0] for row in back["values"]] == pytest.approx([0.0, -1e-4])


def test_a_constant_load_takes_its_part_of_the_critical_load(flexstage: Command, tmp_path: Path) -> None:
    dump(guide(), tmp_path / "guide.toml")
    alone, with_half = (
        flexstage("buckle", "guide.toml", "--scale-load", "platform.fx=-10 N", *more, "--json", "-").document["factor"]
        for more in ((), ("--load", "platform.fx=-5 N"))
    )
    assert with_half == pytest.approx(alone - 0.5, rel=1e-4)


@pytest.mark.usefixtures("two")
def test_what_contradicts_a_path_is_refused(flexstage: Command) -> None:
    ended = flexstage("stroke", "stage.toml", "--path", "out", "--to", "1 mm")
    assert (ended.code, "the path already defines the drive and its ends" in ended.err) == (2, True)
    ended = flexstage("stroke", "stage.toml", "--path", "up")
    assert (ended.code, "unknown path" in ended.err) == (2, True)
    ended = flexstage("stroke", "stage.toml", "--from", "1 mm", "--to", "1 mm")
    assert (ended.code, "first and last value of platform.x are equal (got 1 mm and 1 mm)" in ended.err) == (2, True)


def test_where_a_drive_ends_that_is_not_told(flexstage: Command, two: Path) -> None:
    """A stack at its full stroke, a coordinate at its required one or near rest; of a force nothing is near."""
    (two / "bare.toml").write_text((two / "stage.toml").read_text().partition("[paths")[0])
    for words, end in (
        (["stage.toml", "--drive", "B"], 38e-6),
        (["stage.toml", "--drive", "platform.x"], 18e-6),
        (["stage.toml", "--drive", "platform.y"], 1e-4),
        (["stage.toml", "--drive", "platform.rz"], 1e-3),
        (["bare.toml"], 18e-6),
    ):
        flexstage("stroke", *words, "--steps", "2", "--json", "found.json")
        found = json.loads((two / "found.json").read_text())["along"]
        assert [row[0] for row in found["values"]] == pytest.approx([0.0, end])
    ended = flexstage("stroke", "stage.toml", "--drive", "platform.fx")
    assert (ended.code, "the last value of platform.fx is missing" in ended.err) == (2, True)
