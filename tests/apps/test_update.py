"""The command `update`: document, new file, the old one untouched, and how it ends on bad input."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexstage.cases.double_triangle import double_triangle
from flexstage.experiment.formats.write import write
from flexstage.mechanism.addresses.address import get, set_value, tag_of
from flexstage.mechanism.store import load
from tests.apps.command import Command
from tests.apps.test_documents import matrices
from tests.models.stage_records import stage_record

BUILT = set_value(double_triangle(), "parts.neck.thickness", 1.617e-3)
FREE = ("--parameters", "neck.thickness, steel.density", "--prior", "steel.density=1 %")


@pytest.fixture
def recorded(flexstage: Command, tmp_path: Path) -> Command:
    """The command line in a folder with stage.toml, and record.uff of a stage with a thicker neck."""
    write(tmp_path / "record.uff", stage_record(BUILT))
    return flexstage


def test_update_writes_a_new_file_and_a_document(recorded: Command, tmp_path: Path) -> None:
    before = (tmp_path / "stage.toml").read_bytes()
    ended = recorded("update", "stage.toml", "--record", "record.uff", *FREE, "-o", "updated.toml", "--json", "-")
    assert ended.code == 0, ended.err
    assert "Wrote updated.toml" in ended.err
    assert (tmp_path / "stage.toml").read_bytes() == before
    document = ended.document
    assert (document["kind"], document["model"]) == ("update", "lumped")
    neck = next(each for each in document["parameters"] if each["address"] == "parts.neck.thickness")
    assert neck["change"] == pytest.approx(0.05, abs=0.005)
    assert neck["interval"][0] < 1.617e-3 < neck["interval"][1]
    assert neck["verdict"] == "identified"
    stage = load(tmp_path / "updated.toml")
    assert get(stage, "neck.thickness") == pytest.approx(neck["after"], rel=1e-6)
    assert tag_of(stage, "neck.thickness").startswith("derived update record.uff, +- ")
    assert document["assumed"] == {"prior": 0.1, "priors": {"steel.density": 0.01}, "model_error": 0.001, "gain_error": None}
    assert np.shape(matrices(document)[0]["values"]) == (2, 2)


def test_tables_say_what_the_test_tells(recorded: Command) -> None:
    ended = recorded("update", "stage.toml", "--record", "record.uff", *FREE, "-o", "updated.toml")
    assert ended.code == 0, ended.err
    for title in ("Parameters after the test", "Theory and test", "Correlations after the test", "Identifiable combinations"):
        assert title in ended.out
    assert "identified" in ended.out
    assert recorded("check", "updated.toml").code == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--parameters", "neck.thickness", "-o", "stage.toml"), "stage.toml is also an input of this command"),
        (("--parameters", "neck.thickness", "-o", "record.uff"), "record.uff is also an input of this command"),
        (("--parameters", "neck.thicknes", "-o", "u.toml"), "Use thickness"),
        (("--parameters", "front.thickness", "-o", "u.toml"), "Write horizontal/front.thickness or vertical/front.thickness"),
        (("--parameters", "platform.mass", "-o", "u.toml"), "the body's mass follows from its solids"),
        (("--parameters", "steel.yield_stress", "-o", "u.toml"), "it has no effect on the compared frequencies"),
        (("--parameters", "neck.thickness", "--prior", "200 %", "-o", "u.toml"), "--prior: not a valid relative standard deviation (got"),
        (("--parameters", "neck.thickness", "--model-error", "0.1", "--model-error", "two", "-o", "u.toml"), "--model-error"),
        (
            ("--parameters", "neck.thickness, neck.width, steel.density, steel.young, pole_neck.thickness", "-o", "u.toml"),
            "5 free parameters",
        ),
    ],
)
def test_bad_input_ends_with_code_2_and_writes_nothing(recorded: Command, tmp_path: Path, arguments: tuple[str, ...], said: str) -> None:
    ended = recorded("update", "stage.toml", "--record", "record.uff", *arguments)
    assert ended.code == 2
    assert said in " ".join(ended.err.split())
    assert "Traceback" not in ended.err
    assert not (tmp_path / "u.toml").exists()


def test_records_of_another_stage_are_refused(recorded: Command, tmp_path: Path) -> None:
    made = stage_record(BUILT)
    others = tuple(replace(each, name=each.name.replace("S", "gap")) for each in made.channels)
    write(tmp_path / "other.uff", replace(made, channels=others))
    ended = recorded("update", "stage.toml", "--record", "other.uff", "--parameters", "neck.thickness", "-o", "u.toml")
    assert ended.code == 2
    assert "gap1" in ended.err
    assert not (tmp_path / "u.toml").exists()
