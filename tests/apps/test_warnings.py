"""Warnings and defaults: told by every command on a design, in tables, documents and reports; they stop nothing."""

from __future__ import annotations

import json
from dataclasses import replace
from inspect import signature
from pathlib import Path

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.caveats import caveats, defaults
from flexstage.analysis.loaded.standing import standing
from flexstage.apps.cli.commands import COMMANDS
from flexstage.cases.double_triangle import double_triangle
from flexstage.control.hysteresis.example import example_record
from flexstage.experiment.formats.write import write
from flexstage.mechanism.store import dumps, loads
from flexstage.parts.freedom import Freedom
from flexstage.parts.part import Restricted
from tests.apps.command import Command, design_in, told_everywhere
from tests.apps.test_commands import SPECIFICATION

THICK = ("--set", "parts.foot_notch.profile.radius=0.9 mm")


@pytest.mark.parametrize(
    "command", ["check", "analyse", "mapping", "stiffness", "lost-motion", "modes", "response", "workspace", "drift", "budget"]
)
def test_every_command_tells_warnings_in_its_document_and_its_tables(flexstage: Command, tmp_path: Path, command: str) -> None:
    ended = flexstage(command, "stage.toml", *THICK, "--json", "out.json")
    assert ended.code == 0, ended.err
    document = json.loads((tmp_path / "out.json").read_text())
    (warning,) = (each for each in document["warnings"] if each["where"] == "parts.foot_notch")
    assert set(warning) == {"where", "what", "advice"}
    assert f"\nwarning: parts.foot_notch: {warning['what']}. " in ended.out


@pytest.mark.usefixtures("undrawn")
def test_warnings_follow_the_verdicts(flexstage: Command, tmp_path: Path) -> None:
    design_in(tmp_path, "parallelogram")
    beyond = ("--set", "envelope.x=1 mm")
    ended = flexstage("analyse", "stage.toml", *beyond, "--full", "--report", "out.html", "--json", "out.json")
    assert "got 122 mm, expected 1 mm or less" in told_everywhere(ended, tmp_path / "out.json", tmp_path / "out.html")
    short, whole = flexstage("analyse", "stage.toml", *beyond).out, ended.out
    assert "warning: envelope.x: the stage is larger than the envelope (got 122 mm, expected 1 mm or less)" in short
    assert "\n1 more warning: --full\n" in short
    assert whole.index("Requirements") < whole.index("Mobility") < whole.index("warning: ") < whole.index("Verdict: ")
    page = (tmp_path / "out.html").read_text(encoding="utf-8")
    assert page.index("<h2>Requirements</h2>") < page.index("<h2>Warnings</h2>") < page.index("<h2>Summary</h2>")


def test_a_check_with_warnings_succeeds(flexstage: Command) -> None:
    ended = flexstage("check", "stage.toml", *THICK)
    assert ended.code == 0
    assert "no errors, " in ended.out
    assert " warnings." in ended.out


def test_what_is_taken_by_default_stands_apart(flexstage: Command, tmp_path: Path) -> None:
    massless = ("--set", "parts.stack_vertical.mass=0 kg")
    ended = flexstage("modes", "stage.toml", *massless, "--json", "out.json")
    document = json.loads((tmp_path / "out.json").read_text())
    assert not [each for each in document["warnings"] if each["where"].startswith("parts")]
    assert [each["what"] for each in document["defaults"]] == ["stack mass 0 by default"]
    assert "\ndefault: parts.stack_vertical: stack mass 0 by default. " in ended.out
    assert "default: " not in flexstage("mapping", "stage.toml", *massless).out, "mappings weigh nothing"


def test_the_mass_of_a_restricted_part_is_named() -> None:
    """It counts as a spring only; of a stack of 0.49 kg that is a tenth of a frequency."""
    stage = double_triangle()
    bent = Restricted(stage.parts["stack_vertical"], tuple(each for each in Freedom if each is not Freedom.X))
    found = defaults(replace(stage, parts={**stage.parts, "stack_vertical": bent}))
    assert [(each.where, "omitted (0.49 kg)" in each.what) for each in found if "mass" in each.what] == [("parts.stack_vertical", True)]


def test_caveats_are_lines_that_nothing_folds(flexstage: Command) -> None:
    tables, lines = flexstage("modes", "stage.toml", *THICK).out.split("\nwarning: ", 1)
    assert "Natural frequencies" in tables or "modes" in tables.lower()
    assert lines.startswith("parts.foot_notch: ")
    assert all(line.startswith(("warning: ", "default: ")) and line.endswith(".") for line in lines.splitlines()[1:] if line)


def test_warnings_that_differ_in_value_are_one_line(flexstage: Command, tmp_path: Path) -> None:
    ended = flexstage("stroke", "stage.toml", "--drive", "platform.x", "--to", "50 mm", "--steps", "3", "--json", "out.json")
    stresses = [each for each in json.loads((tmp_path / "out.json").read_text())["warnings"] if each["what"].startswith("stress above")]
    assert len(stresses) > 5
    (line,) = (each for each in ended.out.splitlines() if "stress above" in each)
    largest = max(stresses, key=lambda each: float(each["what"].partition("got ")[2].split()[0]))
    assert line == f"warning: {largest['where']} (worst of {len(stresses)}): {largest['what']}. {largest['advice']}."


def test_caveats_are_worked_out_once_for_one_description() -> None:
    assert caveats(double_triangle()) is caveats(double_triangle())


def leaves(folder: Path, mass: float) -> None:
    """A platform of a mass [kg] on two upright leaves: 5 kg is the border."""
    leaf = fs.Leaf("steel", 0.06, 0.0003, 0.02)
    stage = fs.Mechanism(
        "leaves",
        materials={"steel": fs.Material(young=200e9, poisson=0.0, density=8000.0)},
        parts={"leaf": leaf},
        bodies={"platform": fs.Body(mass=mass, centre=(0.0, 0.0, 0.06), inertia=fs.Inertia(1e-3, 1e-3, 1e-3))},
        links={
            name: fs.Link(("ground", "platform"), "leaf", (x, 0.0, 0.03), (0.0, 0.0, 1.0), bends=(0.0, 1.0, 0.0))
            for name, x in (("a", -0.05), ("b", 0.05))
        },
        requirements={"frequency.platform.1": "at least 3 Hz", "buckling": "at least 1"},
    )
    (folder / "stage.toml").write_text(dumps(stage))


@pytest.mark.parametrize(
    "command", ["check", "analyse", "modes", "stiffness", "response", "sensitivities", "verify", "solid --scope stage"]
)
def test_a_stage_that_its_weight_topples_has_no_elastic_results(flexstage: Command, tmp_path: Path, command: str) -> None:
    leaves(tmp_path, 10.0)
    ended = flexstage(*command.split(), "stage.toml")
    assert ended.code == 2
    assert "load factor 0.503" in ended.err or "load factor 0.502" in ended.err
    told = flexstage("mapping", "stage.toml")
    assert (told.code, "position is unstable" in told.out) == (0, True)


def test_a_model_in_python_is_refused_alike(tmp_path: Path) -> None:
    leaves(tmp_path, 10.0)
    with pytest.raises(fs.DesignError, match="position is unstable"):
        standing(fs.load(tmp_path / "stage.toml"))
    leaves(tmp_path, 2.5)
    stage = fs.load(tmp_path / "stage.toml")
    np.testing.assert_array_equal(standing(stage).stiffness_matrix, fs.lumped(stage).stiffness_matrix)


def test_verdicts_are_of_the_stage_under_its_weight(flexstage: Command, tmp_path: Path) -> None:
    """3.18 Hz as drawn, 2.26 Hz with the weight of 2.5 kg that has reached half of what topples it."""
    leaves(tmp_path, 2.5)
    document = flexstage("analyse", "stage.toml", "--json", "-").document
    frequency, buckling = document["requirements"]
    assert not frequency["passed"]
    assert frequency["value"] == pytest.approx(2.2657, rel=2e-3), "beam-column, rigid in shear"
    assert buckling["value"] == pytest.approx(2.01, rel=5e-3)
    assert document["buckling"]["stage"]["dead"] == pytest.approx(buckling["value"], rel=1e-12)
    assert "load factor 2.01" in document["warnings"][0]["what"]
    leaves(tmp_path, 0.1)
    assert flexstage("modes", "stage.toml", "--json", "-").document["warnings"] == []


STUDY = """format = "flexstage study 1"
design = "leaves.toml"
variables.mass = { address = "bodies.platform.mass", from = "0.1 kg", to = "2.5 kg", levels = 2 }
responses = { f = "frequency.platform.1", m = "mass" }
sweep.sampling = "grid"
"""
TOLERANCE = """format = "flexstage study 1"
design = "leaves.toml"
responses.f = "frequency.platform.1"
scatter.leaf = { address = "leaf.thickness", normal = "50 um" }
tolerance.copies = 8
"""
REPORTED = {
    "identify record.uff": "S is the only output",
    "compare stage.toml --record record.uff": "not found in the experiment",
    "hysteresis stack.csv": "67% of the actuator's range",
    "sweep study.toml -o r.h5 --workers 1": "smallest load factor 2.01 (mass 2.5 kg)",
    "optimise least.toml": "load factor 2.01",
    "optimise front.toml": "smallest load factor 2.01",
    "tolerance tolerance.toml --workers 1": "smallest load factor 0.232 (leaf -0.25 mm)",
    "stroke stage.toml --drive platform.y --steps 2": "got 122 mm, expected 1 mm or less",
    "buckle stage.toml --scale-load platform.fx=-1kN": "got 122 mm, expected 1 mm or less",
    "misalign stage.toml": "got 122 mm, expected 1 mm or less",
    "loop stage.toml --bandwidth 100Hz --hysteresis 15%": "margins, noise and poles do not include hysteresis",
}

AT_LENGTH = {"sweep", "misalign", "optimise", "loop"}
"""Commands that are tried with a report in full only; tests of the parameters beside and of their own files try them always."""


@pytest.fixture
def reported(flexstage: Command, tmp_path: Path) -> Command:
    """The command line in a folder with what the commands that write reports read."""
    leaves(tmp_path, 0.1)
    (tmp_path / "stage.toml").rename(tmp_path / "leaves.toml")
    (tmp_path / "study.toml").write_text(STUDY)
    (tmp_path / "least.toml").write_text(STUDY + 'optimise = { minimise = "f", starts = 1 }')
    (tmp_path / "front.toml").write_text(STUDY + 'optimise = { maximise = ["f", "m"], pareto_points = 3 }')
    (tmp_path / "tolerance.toml").write_text(TOLERANCE)
    design_in(tmp_path, "parallelogram")
    return flexstage


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    ("words", "expected"),
    [pytest.param(*each, marks=pytest.mark.full if each[0].split()[0] in AT_LENGTH else ()) for each in REPORTED.items()],
)
def test_every_report_tells_the_warnings_of_the_document(reported: Command, tmp_path: Path, words: str, expected: str) -> None:
    if "record" in words:
        assert reported(*["rig", "stage.toml", "--seconds", "2", "--model", "mapped", "-o", "record.uff"]).code == 0
    if "stack" in words:
        write(tmp_path / "stack.csv", example_record())
    beyond = ("--limits", "0 V", "1500 V") if "stack" in words else ("--set", "envelope.x=1 mm") if "stage.toml" in words else ()
    ended = reported(*words.split(), *beyond, "--json", "out.json", "--report", "out.html")
    assert ended.code == 0, ended.err
    told = told_everywhere(ended, tmp_path / "out.json", tmp_path / "out.html")
    assert expected in told


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("optimise least.toml -o -", "load factor 2.01"),
        ("sweep study.toml -o r.h5 --workers 1 --report -", "smallest load factor 2.01"),
        ("hysteresis stack.csv --limits 0V 1500V --report -", "67% of the actuator's range"),
    ],
)
def test_a_file_on_stdout_is_there_alone(reported: Command, tmp_path: Path, words: str, told: str) -> None:
    if "stack" in words:
        write(tmp_path / "stack.csv", example_record())
    ended = reported(*words.split(), "--json", "out.json")
    assert ended.code == 0, ended.err
    if "optimise" in words:
        loads(ended.out)
    else:
        assert (ended.out[:15], ended.out.rstrip()[-7:]) == ("<!doctype html>", "</html>")
    assert told in ended.err
    assert told in (tmp_path / "out.json").read_text()


def test_every_command_with_a_report_is_looked_at() -> None:
    asked = {each.name for each in COMMANDS if "report" in signature(each.load()).parameters}
    assert {each.split()[0] for each in REPORTED} | {"analyse", "design", "solid", "verify"} == asked, (
        "analyse: above; design: below; the solid ones: test_solid_commands"
    )


@pytest.mark.usefixtures("undrawn")
def test_the_warnings_of_designed_stages_are_counted_and_those_of_their_check(flexstage: Command, tmp_path: Path) -> None:
    (tmp_path / "spec.toml").write_text(SPECIFICATION)
    ended = flexstage("design", "spec.toml", "-o", "answers", "--architecture", "guide", "--json", "out.json", "--report", "out.html")
    assert ended.code == 0, ended.err
    (answer,) = json.loads((tmp_path / "out.json").read_text())["answers"]
    assert any("platform: modelled as rigid" in each for each in answer["warnings"])
    (line,) = (each.split() for each in ended.out.splitlines() if each.startswith(" 1 "))
    assert line[-1] == str(len(answer["warnings"]))
    assert "Warnings: number of warnings that flexstage check prints." in (tmp_path / "out.html").read_text(encoding="utf-8")
    (design,) = (each for each in (tmp_path / "answers").iterdir() if each.suffix == ".toml" and each.suffixes == [".toml"])
    checked = [each.removeprefix("warning: ") for each in flexstage("check", str(design)).out.splitlines() if each.startswith("warning: ")]
    assert checked == answer["warnings"]


def test_without_stiffness_nothing_is_met(flexstage: Command, tmp_path: Path) -> None:
    leaves(tmp_path, 10.0)
    frequency, buckling = flexstage("analyse", "stage.toml", "--model", "ideal", "--json", "-").document["requirements"]
    assert "position is unstable" in frequency["reason"]
    assert not frequency["passed"]
    assert not buckling["passed"]


def test_a_mass_without_extent_is_told_unless_it_is_meant(flexstage: Command, tmp_path: Path) -> None:
    leaves(tmp_path, 0.1)
    sound = (tmp_path / "stage.toml").read_text()
    inertia = next(line for line in sound.splitlines() if line.startswith("inertia"))
    load = '\n[payloads]\nmirror = {{ body = "platform", mass = "20 g", at = ["0 mm", "0 mm", "60 mm"]{} }}\n'
    text = sound.replace(inertia, "") + load.format("")
    (tmp_path / "stage.toml").write_text(text)
    told = flexstage("modes", "stage.toml", "--set", "parts.leaf.thickness=3 mm", "--json", "-").document
    assert [each["where"] for each in told["warnings"]] == ["bodies.platform", "payloads.mirror"]
    assert all("point mass of" in each["what"] for each in told["warnings"])
    assert min(told["modes"][place]["compliance_share"] for place in told["platform"]) > 0.01
    (tmp_path / "stage.toml").write_text(sound.replace(inertia, "point = true") + load.format(", point = true"))
    assert flexstage("check", "stage.toml", "--json", "-").document["warnings"] == []
    (tmp_path / "stage.toml").write_text(sound.replace(inertia, f"{inertia}\npoint = true"))
    ended = flexstage("check", "stage.toml")
    assert ended.code == 2
    assert "bodies.platform.point" in ended.err


def test_the_error_budget_says_what_its_gauge_noise_is(flexstage: Command, tmp_path: Path) -> None:
    design_in(tmp_path, "parallelogram")
    ended = flexstage("budget", "stage.toml", "--set", "ground=steel", "--json", "out.json")
    assert ended.code == 0, ended.err
    assert "Gauge noise: 3 standard deviations" in ended.out
    assert json.loads((tmp_path / "out.json").read_text())["coverage"] == 3.0
