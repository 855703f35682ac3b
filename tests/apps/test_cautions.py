"""Cautions and defaults: told by every command on a design, in tables, documents and reports; they stop nothing."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from flexstage.cases.double_triangle import double_triangle
from flexstage.studies.cautions import caveats
from tests.apps.command import Command, design_in

THICK = ("--set", "parts.foot_notch.profile.radius=0.9 mm")


@pytest.mark.parametrize(
    "command", ["check", "analyse", "mapping", "stiffness", "lost-motion", "modes", "response", "workspace", "drift", "budget"]
)
def test_every_command_tells_cautions_in_its_document_and_its_tables(flexstage: Command, tmp_path: Path, command: str) -> None:
    ended = flexstage(command, "stage.toml", *THICK, "--json", "out.json")
    assert ended.code == 0, ended.err
    document = json.loads((tmp_path / "out.json").read_text())
    (caution,) = document["cautions"]
    assert caution["where"] == "parts.foot_notch"
    assert set(caution) == {"where", "what", "advice"}
    assert ended.out.index("Cautions") < ended.out.index(caution["what"])


def test_cautions_follow_the_verdicts(flexstage: Command, tmp_path: Path) -> None:
    design_in(tmp_path, "parallelogram")
    beyond = ("--set", "envelope.x=1 mm")
    ended = flexstage("analyse", "stage.toml", *beyond, "--report", "out.html")
    assert ended.out.index("Requirements") < ended.out.index("Cautions") < ended.out.index("Mobility")
    page = (tmp_path / "out.html").read_text(encoding="utf-8")
    assert page.index("<h2>Requirements</h2>") < page.index("<h2>Cautions</h2>") < page.index("<h2>Summary</h2>")


def test_a_check_with_cautions_succeeds(flexstage: Command) -> None:
    ended = flexstage("check", "stage.toml", *THICK)
    assert ended.code == 0
    assert "no findings, 1 caution." in ended.out


def test_what_is_taken_by_default_stands_apart(flexstage: Command, tmp_path: Path) -> None:
    ended = flexstage("mapping", "stage.toml", "--set", "parts.stack_vertical.mass=0 kg", "--json", "out.json")
    document = json.loads((tmp_path / "out.json").read_text())
    assert document["cautions"] == []
    assert [each["what"] for each in document["defaults"]] == ["the stack weighs nothing"]
    assert "Taken by default" in ended.out


def test_caveats_are_worked_out_once_for_one_description() -> None:
    assert caveats(double_triangle()) is caveats(double_triangle())
