"""Notebooks: a stage shows its picture, results and matrices their tables, none of which is loaded before it is shown."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import InNotebook
from flexstage.base.storage.sheet import parts
from flexstage.experiment.example import one_mode_record

STAGE = fs.case("parallelogram")
MODEL, KINEMATICS = fs.lumped(STAGE), fs.ideal(STAGE)


def test_matrices_show_units_and_hide_rounding_noise() -> None:
    page = Matrix(np.array([[2e6, 1e-7], [0.0, 3e6]]), ("fx", "fy"), ("x", "y"), (("N/m", "N/m"),) * 2)._repr_html_()
    assert "µm" in page
    assert "[N]" in page
    assert "1e-1" not in page
    assert "rounding noise" in page


@pytest.mark.parametrize(
    "result",
    [KINEMATICS, KINEMATICS.mapping, fs.statics(MODEL), fs.modes(MODEL), fs.lost_motion(KINEMATICS, MODEL), fs.drift(STAGE, MODEL)],
    ids=lambda result: type(result).__name__,
)
def test_results_show_their_tables(result: InNotebook) -> None:
    assert "<table>" in result._repr_html_()


def test_a_result_without_tables_of_its_own_shows_all_its_parts() -> None:
    found = fs.workspace(STAGE, KINEMATICS, MODEL).stress
    page = found._repr_html_() if found else ""
    assert page.count("<table>") == len(list(parts(found)))
    assert "weakest" in page
    record = one_mode_record()
    identified = fs.experiment.identify(record)._repr_html_()
    assert "frequency" in identified
    assert "duration" in record._repr_html_()
    assert "rms" in fs.experiment.examine(record)._repr_html_()


ANALYSED = fs.analyse(STAGE)
STATE = fs.equilibrium(fs.nonlinear(STAGE))


@pytest.mark.parametrize(
    "result",
    [
        STAGE,
        KINEMATICS,
        MODEL,
        STATE,
        STATE.model,
        ANALYSED,
        *(getattr(ANALYSED, name) for name in ("modes", "statics", "workspace", "drift")),
    ],
    ids=lambda result: type(result).__name__,
)
def test_printed_results_have_at_most_25_lines(result: InNotebook) -> None:
    lines = str(result).splitlines()
    assert 3 < len(lines) <= 25
    assert max(map(len, lines)) <= 140


def test_check_returns_the_errors_or_the_warnings_of_the_command() -> None:
    leaf = replace(STAGE.parts["leaf"], thickness=0.4, width=0.5, length=4.0)
    broken, thick = replace(STAGE, materials={}), replace(STAGE, parts={**STAGE.parts, "leaf": leaf}, formulas={})
    assert {each.severity.value for each in fs.check(broken)} == {"error"}
    assert "parts.leaf.thickness" in {each.where for each in fs.check(thick) if each.severity.value == "warning"}
    assert "error" not in {each.severity.value for each in fs.check(STAGE)}


def test_a_stage_shows_its_picture() -> None:
    assert STAGE._repr_html_().startswith("<svg ")


def test_a_stage_that_cannot_be_drawn_says_why() -> None:
    broken = fs.Mechanism("x", links={"a": fs.Link(("ground", "b"), "missing", (0.0, 0.0, 0.0), along=fs.X)})
    page = broken._repr_html_()
    assert page.startswith("<p>")
    assert "missing" in page


def test_figures_are_loaded_when_something_is_shown() -> None:
    code = "import flexstage as fs, sys; fs.modes(fs.lumped(fs.case('parallelogram'))); assert 'flexstage.show.notebook' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
