"""The commands `solid`, `verify` and `calibrate`: documents, tables, reports, and how they end on bad input."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.processes.progress import Step
from flexstage.cases.registry import case
from flexstage.mechanism.restrict import restrict
from flexstage.parts.freedom import Freedom
from flexstage.show.command.progress import progress_bar
from flexstage.solid.fea.jobs import install
from flexstage.solid.results import resolution
from tests.apps.command import Command, command_in, told_everywhere
from tests.apps.test_documents import ENVELOPE, page_section
from tests.models.small_solids import propped
from tests.models.solid_studies import COARSE, small, small_unit

ROUGH = ("--accuracy", "5 %", "--order", "3")
"""One accuracy and order for all: every hinge is computed once."""


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfdbinary: Any) -> Command:
    """Runs commands in a folder with a stage of few elements, read at one resolution, so that every component is reduced once."""
    monkeypatch.setattr(resolution, "reduction_of_order", lambda _: COARSE)
    monkeypatch.setattr(resolution, "coarsen", lambda _: COARSE)
    fs.dump(small(), tmp_path / "stage.toml", {"parts.neck": "As drawn."})
    return command_in(tmp_path, monkeypatch, capfdbinary)


def test_hinges(command: Command) -> None:
    found = command("solid", "stage.toml", "--scope", "hinge", *ROUGH, "--json", "-").document
    assert found["kind"] == "solid"
    assert set(found["hinges"]) == {"leaf", "neck-back", "neck-front"}
    back, front = (found["hinges"][f"neck-{end}"] for end in ("back", "front"))
    assert back["links"] == ["drive/back"]
    assert (back["roots"], front["roots"]) == ({"first": False, "second": True}, {"first": True, "second": False})
    first, second = (np.array(neck["compliance"]["values"]) for neck in (back, front))
    np.testing.assert_allclose(np.diag(second), np.diag(first), rtol=1e-9)  # one is the other turned end for end
    assert second[1, 5] == pytest.approx(-first[1, 5], rel=1e-9)
    assert 0.93 * 7.44e-9 < first[0, 0] < 7.44e-9  # that of the neck with both roots, to 3 %
    assert back["error"] < 0.05


def test_units(command: Command, tmp_path: Path) -> None:
    ended = command("solid", "stage.toml", "--scope", "unit", "--json", "-", "--report", "units.html")
    assert ended.code == 0, ended.err
    unit = ended.document["units"]["drive"]
    assert unit["axial_n_per_m"] == pytest.approx(small_unit().axial)
    assert unit["commands_m"][-1] == pytest.approx(38e-6)
    page = (tmp_path / "units.html").read_text(encoding="utf-8")
    assert "Isolated units as solids" in page
    assert "Output and lost motion of the drive unit over its stroke" in page


def test_the_stage(command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resolution, "changes", lambda *_: {"mode 1": 0.3})
    ended = command("solid", "stage.toml", "--order", "3", "--report", "stage.html", "--json", "stage.json")
    assert ended.code == 0, ended.err
    told = told_everywhere(ended, tmp_path / "stage.json", tmp_path / "stage.html")
    assert "30 % at order 3; 1 % required" in told
    for title in ("Stiffness at platform", "Modes", "Elasticity of the bodies", "Highest stress over the strokes"):
        assert title in ended.out
    page = (tmp_path / "stage.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 15  # the stage; six platform modes and the stress, a colour bar each
    assert not re.search(r"(src|href)=.?https?:|url\(.?https?:", page)
    assert "mode fea 1" in page  # beside its partner of theory


def test_verification(command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resolution, "changes", lambda *_: {"mode 1": 0.3})
    ended = command("verify", "stage.toml", *ROUGH, "--json", "v.json", "--report", "v.html")
    assert ended.code == 0, ended.err
    told = told_everywhere(ended, tmp_path / "v.json", tmp_path / "v.html")
    assert told.count("30 % at order 3; 5 % required") == 2, "units and stage"
    notes = ended.err.splitlines()
    (plan,) = (number for number, line in enumerate(notes) if line.startswith("to do: "))
    verdicts = json.loads((tmp_path / "v.json").read_text(encoding="utf-8"))["verdicts"]
    if not notes[plan].startswith("to do: nothing"):
        at = {name: next(number for number, line in enumerate(notes) if line.startswith(f"{name}: ")) for name in verdicts}
        assert plan < max(at[name] for name in at if name.startswith("hinge")) < at["stage"]
    assert command("verify", "stage.toml", *ROUGH).err.startswith("to do: nothing, ")
    assert "Verdicts" in ended.out
    assert "Theory and finite elements: stage" in ended.out
    assert "Theory and finite elements" in (tmp_path / "v.html").read_text(encoding="utf-8")


def test_calibration_is_told_from_theory(command: Command, tmp_path: Path) -> None:
    ended = command("calibrate", "stage.toml", "-o", "calibrated.toml", *ROUGH)
    assert ended.code == 0, ended.err
    assert "Difference in compliance between FEA and beam theory" in ended.out
    assert "# As drawn." in (tmp_path / "calibrated.toml").read_text(encoding="utf-8")
    assert command("modes", "calibrated.toml").code == 0
    rows = command("verify", "calibrated.toml", *ROUGH, "--json", "-").document["rows"]
    assert {row["trust"] for row in rows} == {"not independent"}
    axial = next(row for row in rows if row["figure"] == "axial stiffness")
    assert axial["calibration"] == ["neck-back", "neck-front"]
    assert abs(axial["difference"]) < 0.01


@pytest.mark.parametrize(
    "words",
    [
        ("solid", "stage.toml", "--scope", "unit"),
        ("solid", "stage.toml", "--scope", "stage"),
        ("verify", "stage.toml"),
        ("calibrate", "stage.toml", "-o", "out.toml"),
    ],
)
def test_every_key_is_documented(command: Command, words: tuple[str, ...]) -> None:
    document = command(*words, *ROUGH, "--json", "-").document
    section = page_section(words[0])
    assert [key for key in document if key not in ENVELOPE and not re.search(rf"`{key}[`.\[]", section)] == []


def test_what_has_no_shape_is_named(command: Command, tmp_path: Path) -> None:
    stage = restrict(small(), {"leaf": ((Freedom.X,), ())})
    fs.dump(stage, tmp_path / "restricted.toml")
    for words in (("solid", "restricted.toml"), ("verify", "restricted.toml")):
        ended = command(*words)
        assert ended.code == 2
        assert "left: some of its DOFs are locked or freed" in ended.err
        assert "Traceback" not in ended.err


def test_a_stage_without_units_of_its_own(command: Command, tmp_path: Path) -> None:
    fs.dump(case("bridge"), tmp_path / "bridge.toml")
    ended = command("solid", "bridge.toml", "--scope", "unit", "--json", "out.json")
    assert ended.code == 2
    assert "no unit of the stage drives its own output" in ended.err
    assert not (tmp_path / "out.json").exists()


def test_a_stand_in_for_a_part_that_is_gone(command: Command, tmp_path: Path) -> None:
    stage = small()
    unit = tuple(tuple(1e-7 * (row == column) for column in range(6)) for row in range(6))
    leaf = fs.ComplianceMatrix(unit, free=stage.parts["leaf"].intended, replaces="gone")
    fs.dump(replace(stage, parts={**stage.parts, "leaf": leaf}), tmp_path / "lost.toml")
    ended = command("solid", "lost.toml")
    assert ended.code == 2
    assert 'parts.leaf.replaces: unknown part "gone"' in ended.err


@pytest.mark.parametrize("words", [("solid", "stage.toml"), ("verify", "stage.toml")])
def test_a_missing_solver(command: Command, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]) -> None:
    monkeypatch.setattr(install, "SOLVER_VERSION", "0.0")
    ended = command(*words, "--set", "parts.leaf.width=19.7 mm")  # of another width nothing is in the cache
    assert ended.code == 2
    assert "ngsolve" in ended.err
    assert "pip install" in ended.err


def test_bad_wishes(command: Command) -> None:
    assert "must be between 1e-6 and 1" in command("solid", "stage.toml", "--accuracy", "500 %").err
    assert command("solid", "stage.toml", "--accuracy", "1 mm").code == 2
    assert command("solid", "stage.toml", "--order", "1").code == 2
    assert command("calibrate", "stage.toml", "-o", "stage.toml").code == 2
    assert command("solid", "stage.toml", "--json", "nowhere/out.json").code == 2


def test_interruption_writes_nothing(command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("flexstage.solid.results.verification.solid_stage", interrupted)
    ended = command("solid", "stage.toml", "--json", "out.json", "--report", "out.html")
    assert ended.code == 130
    assert sorted(path.name for path in tmp_path.iterdir()) == ["stage.toml"]


PROGRAM = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # what a shell runs in the background ignores it
from flexstage.apps.cli import main
main()
"""


@pytest.mark.full  # its twins: the run that was stopped, of the cache; the interruptions of processes, and of the command above
@pytest.mark.skipif(sys.platform != "linux", reason="sends the signal of a keyboard")
def test_an_interruption_ends_with_the_code_of_its_signal_and_the_same_command_resumes(tmp_path: Path) -> None:
    drawn = propped(6e-3, 7e-3)
    links = {name.replace(" ", "_"): replace(link, part=link.part.replace(" ", "_")) for name, link in drawn.links.items()}
    parts = {name.replace(" ", "_"): part for name, part in drawn.parts.items()}
    fs.dump(replace(drawn, parts=parts, links=links), tmp_path / "stage.toml")
    (tmp_path / "temporary").mkdir()
    environment = os.environ | {"FLEXSTAGE_CACHE": str(tmp_path / "cache"), "TMPDIR": str(tmp_path / "temporary")}
    one = "import os; os.sched_setaffinity(0, list(os.sched_getaffinity(0))[:1])\n"  # one part after the other: the second is not yet done
    words = [sys.executable, "-c", one + PROGRAM, "solid", "stage.toml", "--order", "2", "--json", "out.json"]
    with subprocess.Popen(words, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True) as process:
        while not list((tmp_path / "cache").glob("*.superelement")) and process.poll() is None:
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate()
    assert process.returncode == 130
    assert "\nInterrupted. Nothing was written. Finished results are kept for --resume: " in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cache", "stage.toml", "temporary"]
    assert not list((tmp_path / "temporary").iterdir())
    kept = {path.name for path in (tmp_path / "cache").iterdir()}
    assert not any(name.endswith(".part") for name in kept)
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert kept < {path.name for path in (tmp_path / "cache").iterdir()}
    assert (tmp_path / "out.json").is_file()


@pytest.mark.parametrize(
    ("memory", "said"),
    [
        ("8", '--memory: unit missing (got "8"). Use a size of memory, e.g. "8 GB".'),
        ("0 GB", "--memory: must be a size of memory (got 0 GB)."),
        ("-1 GB", "--memory: must be a size of memory (got -1 GB)."),
        ("8 mm", '--memory: must be a size of memory (got "8 mm", a length).'),
    ],
)
def test_impossible_memory_is_refused_at_once(command: Command, memory: str, said: str) -> None:
    for words in (("solid", "stage.toml"), ("verify", "stage.toml"), ("calibrate", "stage.toml", "-o", "out.toml")):
        ended = command(*words, "--memory", memory)
        assert ended.code == 2
        assert said in ended.err


@pytest.mark.parametrize("scope", [pytest.param("hinge", marks=pytest.mark.full), "stage"])
def test_too_little_memory_is_refused_by_name(command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, scope: str) -> None:
    monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / "cache"))
    ended = command("solid", "stage.toml", "--scope", scope, "--memory", "1 MB")
    assert ended.code == 2
    needed, available = (
        ("leaf: its coarsest mesh needs", "(0.001 GB available)")
        if scope == "hinge"
        else ("left: its reduction at order 2 needs", "0.001 GB are available")
    )
    assert needed in ended.err
    assert available in ended.err


def test_memory_is_the_limit_of_all_that_is_computed(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float | None] = []
    monkeypatch.setattr("flexstage.solid.results.verification.verify", lambda *_: pytest.fail("computed"))
    monkeypatch.setattr("flexstage.solid.commands.solid.work_ahead", lambda _todo, ways: asked.append(ways.limits.memory))
    monkeypatch.setattr("flexstage.solid.commands.solid.solids", lambda ways: asked.append(ways.limits.memory))
    monkeypatch.setattr("flexstage.solid.commands.solid.hinges", lambda _accuracy, _order, ways: asked.append(ways.limits.memory))
    with pytest.raises(pytest.fail.Exception):
        command("verify", "stage.toml", "--memory", "3 GB")
    assert asked == [3e9, 3e9, 3e9]


def test_outlines_that_do_not_meet_are_named(command: Command, tmp_path: Path) -> None:
    stage = fs.case("parallelogram")
    left = replace(stage.links["left"], at=tuple(np.add(stage.links["left"].at, (0.0, 2e-5, 0.0)).tolist()))
    fs.dump(replace(stage, links={**stage.links, "left": left}), tmp_path / "apart.toml")
    ended = command("solid", "apart.toml", "--json", "out.json")
    assert ended.code == 2
    assert "left: its end face is 20 um away from platform" in ended.err
    assert not (tmp_path / "out.json").exists()


def test_the_bar_is_silent_without_a_terminal(capfd: Any) -> None:
    with progress_bar() as shown:
        shown.step(Step("lever: meshing", 0.5, 70.0))
    assert capfd.readouterr() == ("", "")


def test_a_step_that_finite_elements_refuse_is_named_by_check(command: Command, tmp_path: Path) -> None:
    """A step of 32 um: the finding of `verify`, as a warning of `check`."""
    notch = fs.Notch("al", 1e-3, 10e-3, fs.Circular(3e-3))
    solids = {
        "arm": fs.Block("al", (0.04, 0.01, 0.01), (0.023, 0.0, 0.0)),
        "step": fs.Block("al", (0.02, 0.010064, 0.01), (0.03, 0.0, 0.0)),
    }
    link = fs.Link(("ground", "platform"), "hinge", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    material = fs.Material(young=71.7e9, poisson=0.33, density=2810.0)
    fs.dump(
        fs.Mechanism("rim", {"al": material}, {"hinge": notch}, {"platform": fs.Body(solids=solids)}, {"hinge": link}),
        tmp_path / "rim.toml",
    )
    (finding,) = [line.removeprefix("error: ") for line in command("verify", "rim.toml").err.splitlines() if line.startswith("error: ")]
    ended = command("check", "rim.toml")
    assert ended.code == 0
    assert "an edge 32 um long is left" in finding
    assert f"warning: finite elements: {finding}" in ended.err
