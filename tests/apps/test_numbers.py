"""Named numbers end to end: what a study moves by one name is what it moves by all the values that are worked out of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.addresses.address import set_text
from flexstage.mechanism.mechanism import NamedNumber
from flexstage.mechanism.store import dump, loads
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.optimisation.search.optimum import optimise
from flexstage.studies.optimisation.stage_text import design_text, write_optimum
from flexstage.studies.sweeps.execution.evaluate import piece
from flexstage.studies.sweeps.execution.run import Run
from flexstage.studies.sweeps.file import load_study
from flexstage.studies.tolerances.file import load_tolerance
from flexstage.studies.tolerances.run import tolerance
from tests.apps.command import Command, command_in

STUDY = """
format = "flexstage study 1"
name = "leaves"
design = "stage.toml"
variables.leaf = { address = OF, from = "0.6 mm", to = "1.4 mm", step = "10 um", levels = 3 }
responses.f1 = "frequency.platform.1"
sweep = { sampling = "grid" }
optimise = { maximise = "f1", starts = 1 }
"""
TOLERANCE = """
format = "flexstage study 1"
name = "made"
design = "stage.toml"
scatter.wire = { address = OF, uniform = "5 um" }
responses.f1 = "frequency.platform.1"
tolerance = { copies = 16, requirements = false }
"""
BY_NAME, BY_VALUES = '"numbers.thin"', '["parts.leaf.thickness", "parts.neck.thickness"]'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The parallelogram, its leaves and necks both as thick as a number says."""
    stage = replace(parallelogram(), numbers={"thin": NamedNumber(0.001, "mm")}, requirements={})
    for part in ("leaf", "neck"):
        stage = set_text(stage, f"parts.{part}.thickness", "thin")
    dump(stage, tmp_path / "stage.toml")
    for name, of in (("name", BY_NAME), ("values", BY_VALUES)):
        (tmp_path / f"{name}.toml").write_text(STUDY.replace("OF", of))
    return tmp_path


def test_a_sweep_of_a_number_is_one_of_all_that_depends_on_it(folder: Path) -> None:
    found = []
    for name in ("name", "values"):
        study = load_study(folder / f"{name}.toml")
        found.append(piece(study, 0, study.plan.designs).responses)
    assert np.ptp(found[0]) > 100.0
    assert np.allclose(*found, rtol=1e-9)


def test_an_optimum_of_a_number_is_written_to_the_number(folder: Path) -> None:
    """The search, with its exact slopes, takes the same way; the design file keeps its formulas."""
    found = []
    for name in ("name", "values"):
        study = load_study(folder / f"{name}.toml")
        found.append(optimise(study, load_optimisation(study)).point)
    assert found[0] is not None
    assert np.allclose(found[0].shares, found[1].shares, atol=1e-9)
    assert np.allclose(found[0].gradient, found[1].gradient, rtol=1e-9)
    study = load_study(folder / "name.toml")
    text = write_optimum(design_text(study, folder), study, load_optimisation(study), [0.0014])
    assert 'thickness = "thin"' in text
    assert 'thin = "1.4 mm"' in text
    stage = loads(text)
    assert stage.parts["neck"].thickness == 0.0014
    assert stage.tags["numbers.thin"].startswith("derived optimise")


def test_a_tolerance_of_a_number_is_one_of_all_that_depends_on_it(folder: Path) -> None:
    slopes = []
    for of in (BY_NAME, BY_VALUES):
        (folder / "made.toml").write_text(TOLERANCE.replace("OF", of))
        slopes.append(tolerance(load_tolerance(folder / "made.toml"), how=Run(workers=1)).slopes.gradient)
    assert np.allclose(*slopes, rtol=1e-9)


def test_assignments_move_what_depends_on_a_number_and_say_what_formula_they_take_out(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capfdbinary: Any
) -> None:
    flexstage: Command = command_in(folder, monkeypatch, capfdbinary)
    by_name = flexstage("modes", "stage.toml", "--set", "numbers.thin=+10%", "--json", "-").document
    by_values = flexstage("modes", "stage.toml", "--set", "leaf.thickness=1.1 mm", "--set", "neck.thickness=+10%", "--json", "-")
    assert by_name["modes"][0]["frequency_hz"] == pytest.approx(by_values.document["modes"][0]["frequency_hz"], rel=1e-12)
    assert (
        'the value of parts.leaf.thickness replaces its formula "thin". To change all dependent values, set numbers.thin' in by_values.err
    )
    ended = flexstage("modes", "stage.toml", "--set", "numbers.thin=1.1 N")
    assert ended.code == 2
    assert "--set numbers.thin=1.1 N" in ended.err


def test_a_number_that_nothing_refers_to_is_a_warning(folder: Path, monkeypatch: pytest.MonkeyPatch, capfdbinary: Any) -> None:
    flexstage = command_in(folder, monkeypatch, capfdbinary)
    text = (folder / "stage.toml").read_text().replace("[numbers]", '[numbers]\nspare = "3 mm"')
    (folder / "stage.toml").write_text(text)
    ended = flexstage("check", "stage.toml")
    assert ended.code == 0
    assert "numbers.spare: no formula or requirement uses it" in " ".join((ended.out + ended.err).split())
