"""The command `hysteresis`: every form of record, document, file, report, and how it ends on bad input."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from flexstage.control.hysteresis.example import example_record, example_step, example_test
from flexstage.control.hysteresis.models.inverse import inverse
from flexstage.control.hysteresis.stack import load_hysteresis
from flexstage.experiment.formats.write import write
from flexstage.experiment.records.record import Channel, in_memory
from tests.apps.command import Command

RECORD = example_record()


@pytest.fixture
def recorded(flexstage: Command, tmp_path: Path) -> Command:
    """The command line in a folder with stack.csv, and step.uff for creep."""
    write(tmp_path / "stack.csv", RECORD)
    write(tmp_path / "step.uff", example_step())
    return flexstage


def test_a_document_a_file_and_a_report_are_written(recorded: Command, tmp_path: Path) -> None:
    named = ("--volts", "u", "--stroke", "y", "--step", "step.uff")
    ended = recorded("hysteresis", "stack.csv", *named, "-o", "stack.toml", "--json", "-", "--report", "stack.html")
    assert ended.code == 0, ended.err
    document = ended.document
    assert document["kind"] == "hysteresis"
    assert document["channels"] == {"volts": "u", "stroke": "y"}
    found = document["hysteresis"]
    assert found["width"] == pytest.approx(0.15, abs=0.003)
    assert found["rms"] < 0.005
    assert document["inverse_rms"] < 0.005
    assert document["creep"]["law"]["rate"] == pytest.approx(0.02, abs=0.0002)
    stack = load_hysteresis(tmp_path / "stack.toml")
    assert list(stack.thresholds) == found["plays"]["thresholds_v"]
    assert list(stack.weights) == found["plays"]["weights_m_per_v"]
    assert stack.source == "stack.csv"
    assert inverse(stack.model).axes == 1
    page = (tmp_path / "stack.html").read_text()
    assert "Hysteresis of a stack" in page
    assert page.count("<svg") == 1


@pytest.mark.parametrize("form", ["uff", "mat", "h5"])
def test_every_form_of_record_says_the_same(recorded: Command, tmp_path: Path, form: str) -> None:
    write(tmp_path / f"stack.{form}", RECORD)
    found = recorded("hysteresis", f"stack.{form}", "--json", "-").document
    assert found["hysteresis"]["plays"]["weights_m_per_v"] == pytest.approx(list(example_test().stack.weights), rel=1e-6)


def test_tables_say_what_the_model_is(recorded: Command) -> None:
    ended = recorded("hysteresis", "stack.csv", "--limits", "0 V", "1500 V")
    assert ended.code == 0
    assert "Hysteresis of the stack" in ended.out
    assert "Plays" in ended.out
    assert "67% of the actuator's range" in ended.out


def test_the_file_alone_goes_to_stdout(recorded: Command) -> None:
    ended = recorded("hysteresis", "stack.csv", "-o", "-")
    assert ended.out.startswith("# Hysteresis of a stack")
    assert 'format = "flexstage hysteresis 1"' in ended.out


def test_units_can_be_stated(recorded: Command, tmp_path: Path) -> None:
    bare = replace(RECORD, channels=(Channel("u"), Channel("y")))
    write(tmp_path / "bare.csv", bare)
    refused = recorded("hysteresis", "bare.csv")
    assert refused.code == 2
    assert "none of the channels (u [no unit], y [no unit]) is in volts" in refused.err
    assert recorded("hysteresis", "bare.csv", "--units", "u=V", "--units", "y=um", "--json", "-").code == 0


def ended_badly(recorded: Command, *arguments: str) -> str:
    ended = recorded("hysteresis", *arguments)
    assert ended.code == 2, ended.err
    assert ended.out == ""
    assert "Traceback" not in ended.err
    return ended.err


def test_bad_input_ends_with_findings(recorded: Command, tmp_path: Path) -> None:
    values = RECORD.samples.read(0, RECORD.length)
    once = in_memory(RECORD.channels, 100.0, values[:51])
    three = in_memory([*RECORD.channels, Channel("z", "um")], 100.0, np.column_stack([values, values[:, 1]]))
    dead = in_memory(RECORD.channels, 100.0, values * np.array([1.0, 0.0]))
    for name, record in (("once", once), ("three", three), ("dead", dead)):
        write(tmp_path / f"{name}.csv", record)
    assert "once.csv: volts: the voltage changes from 0 V to 1000 V without reversal" in ended_badly(recorded, "once.csv")
    assert "of the channels (u [V], y [um], z [um]) are in a unit of length" in ended_badly(recorded, "three.csv")
    assert "dead.csv: stroke: all samples equal 0: the channel has no signal" in ended_badly(recorded, "dead.csv")
    assert "there is no channel w" in ended_badly(recorded, "stack.csv", "--stroke", "w")
    exchanged = ended_badly(recorded, "stack.csv", "--volts", "y", "--stroke", "u")
    assert "y is in um (expected volts)" in exchanged
    assert "u is in V (expected a unit of length)" in exchanged
    assert "file not found" in ended_badly(recorded, "none.csv")
    assert "not a range (got 1000 V to 0 V" in ended_badly(recorded, "stack.csv", "--limits", "1000 V", "0 V")
    assert "step.uff: record: ends too soon after the step" not in ended_badly(recorded, "stack.csv", "--step", "stack.csv")
    assert "stack.csv is also an input of this command" in ended_badly(recorded, "stack.csv", "-o", "stack.csv")


def test_responses_show_no_hysteresis(recorded: Command, tmp_path: Path) -> None:
    savemat(tmp_path / "responses.mat", {"f": np.arange(1.0, 9.0), "H": np.ones((8, 1, 1), dtype=complex)})
    assert 'it has no array "samples"' in ended_badly(recorded, "responses.mat")
