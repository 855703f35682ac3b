"""Output files: found unwritable before anything is computed, complete or not there, and what they hold."""

from __future__ import annotations

import csv
import json
import os
import stat
import zipfile
from inspect import signature
from pathlib import Path

import numpy as np
import pytest
import tomlkit
from scipy.io import loadmat

from flexstage.analysis import complete
from flexstage.analysis.dynamics.modes import modes
from flexstage.apps.cli.commands import COMMANDS
from flexstage.base.finding import refuse
from flexstage.base.storage import store
from flexstage.mechanism.store import load
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.show.command import output
from tests.apps.command import Command, design_in

BAD_TARGETS = {
    ("--report", "nowhere/report.html"): "nowhere/report.html cannot be written: folder nowhere not found",
    ("--json", "folder"): "it is a folder",
    ("--mat", "stage.toml"): "also an input of this command",
    ("--report", "stage.toml"): "also an input of this command",
    ("--xlsx", "stage.toml"): "also an input of this command",
}


def test_every_command_that_writes_tables_writes_workbooks(flexstage: Command, tmp_path: Path) -> None:
    options = {each.name: signature(each.load()).parameters for each in COMMANDS}
    assert {name for name, known in options.items() if "csv" in known} == {name for name, known in options.items() if "xlsx" in known}
    ended = flexstage("modes", "stage.toml", "--xlsx", "found.xlsx", "--json", "-")
    assert ended.document["kind"] == "modes"
    with zipfile.ZipFile(tmp_path / "found.xlsx") as files:
        text = files.read("xl/sharedStrings.xml").decode()
    assert ended.document["physics_digest"] in text


@pytest.mark.parametrize("option", sorted(BAD_TARGETS))
def test_unwritable_outputs_are_found_before_anything_is_computed(
    flexstage: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, option: tuple[str, str]
) -> None:
    (tmp_path / "folder").mkdir()
    monkeypatch.setattr(complete, "analyse", lambda *_: pytest.fail("computed all the same"))
    before = (tmp_path / "stage.toml").read_bytes()
    ended = flexstage("analyse", "stage.toml", *option)
    assert ended.code == 2
    assert BAD_TARGETS[option] in ended.err
    assert (tmp_path / "stage.toml").read_bytes() == before


def test_tables_are_csv_files_of_full_precision(flexstage: Command, tmp_path: Path) -> None:
    ended = flexstage("stiffness", "stage.toml", "--csv", "tables", "--json", "found.json")
    assert ended.code == 0, ended.err
    found = json.loads((tmp_path / "found.json").read_text())
    lines = {path.name: list(csv.reader(path.read_text().splitlines())) for path in (tmp_path / "tables").iterdir()}
    head, *entries = lines["stiffness.stiffness.csv"]
    assert head == ["row", "column", "unit", "value"]
    stated = found["stiffness"]
    assert [each[:2] for each in entries] == [[row, column] for row in stated["rows"] for column in stated["columns"]]
    assert [float(each[3]) for each in entries] == [value for line in stated["values"] for value in line]
    assert [float(each) for _, each in lines["stiffness.centre_m.csv"][1:]] == found["centre_m"]


@pytest.mark.parametrize("folder", ["stage.toml", "nowhere/tables", 300 * "x"])
def test_a_folder_for_csv_files_is_tried_first(flexstage: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: str) -> None:
    monkeypatch.setattr(complete, "analyse", lambda *_: pytest.fail("computed all the same"))
    before = sorted(tmp_path.iterdir())
    ended = flexstage("analyse", "stage.toml", "--csv", folder)
    assert ended.code == 2
    assert "--csv" in ended.err
    assert sorted(tmp_path.iterdir()) == before


LONG = 300 * "x"


@pytest.mark.parametrize(
    "words",
    [
        f"modes stage.toml --json {LONG}.json",
        f"modes stage.toml --json {LONG}/x.json",
        "modes stage.toml --json stage.toml/x.json",
        "modes stage.toml --json loop/x.json",
        f"modes {LONG}.toml",
        f"new {LONG}.toml",
        f"plan stage.toml -o {LONG}.svg",
        f"cad stage.toml -o {LONG}.step",
        f"rig stage.toml --seconds 1 -o {LONG}.uff",
        f"identify {LONG}.uff",
        f"loop stage.toml --export {LONG}.c",
        f"loop stage.toml --trajectory {LONG}.csv",
        f"sweep {LONG}.toml -o r.h5",
        f"sweep study.toml -o {LONG}.h5",
        f"sweep study.toml -o {248 * 'x'}.h5",
        f"tolerance study.toml -o {LONG}.h5",
    ],
)
def test_names_that_no_disk_takes_are_refused(flexstage: Command, tmp_path: Path, words: str) -> None:
    (tmp_path / "study.toml").write_text(
        'format = "flexstage study 1"\ndesign = "stage.toml"\nresponses.m = "mass"\n'
        'variables.t = { address = "neck.thickness", from = "1 mm", to = "2 mm" }\n'
        'scatter.t = { address = "neck.thickness", normal = "1 um" }\n'
    )
    (tmp_path / "loop").symlink_to("loop")
    before = sorted(tmp_path.iterdir())
    ended = flexstage(*words.split())
    assert ended.code == 2, ended.err
    assert sorted(tmp_path.iterdir()) == before


def test_two_outputs_need_two_files(flexstage: Command) -> None:
    ended = flexstage("analyse", "stage.toml", "--json", "out", "--mat", "./out")
    assert ended.code == 2
    assert "the output of --json" in ended.err


@pytest.mark.usefixtures("undrawn")
def test_stdout_holds_one_output_only(flexstage: Command) -> None:
    ended = flexstage("analyse", "stage.toml", "--json", "-", "--report", "-")
    assert ended.code == 2
    assert "stdout is also the output of --json" in ended.err
    page = flexstage("analyse", "stage.toml", "--model", "ideal", "--report", "-")
    assert page.out.startswith("<!doctype html>")
    assert page.out.rstrip().endswith("</html>")


def test_write_protected_files_stay(flexstage: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "out.json").write_text("old")
    allowed = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path).name != "out.json" and allowed(path, mode))
    ended = flexstage("modes", "stage.toml", "--json", "out.json")
    assert ended.code == 2
    assert "write-protected" in ended.err
    assert (tmp_path / "out.json").read_text() == "old"


def test_a_full_disk_leaves_the_old_file_and_nothing_else(flexstage: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "out.json").write_text("old")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    ended = flexstage("modes", "stage.toml", "--json", "out.json")
    assert ended.code == 2
    assert "No space left on device" in ended.err
    assert (tmp_path / "out.json").read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.json", "stage.toml"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_full_device_is_told(flexstage: Command) -> None:
    ended = flexstage("modes", "stage.toml", "--json", "/dev/full")
    assert ended.code == 2
    assert "/dev/full" in ended.err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_outputs_appear_together_or_not_at_all(flexstage: Command, tmp_path: Path) -> None:
    (tmp_path / "out.json").write_text("old")
    ended = flexstage("analyse", "stage.toml", "--json", "out.json", "--mat", "/dev/full")
    assert ended.code == 2
    assert "Wrote" not in ended.err
    assert (tmp_path / "out.json").read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.json", "stage.toml"]


def test_files_are_written_with_the_modes_of_files(flexstage: Command, tmp_path: Path) -> None:
    flexstage("modes", "stage.toml", "--json", "new.json")
    (tmp_path / "plain").touch()
    assert stat.S_IMODE((tmp_path / "new.json").stat().st_mode) == stat.S_IMODE((tmp_path / "plain").stat().st_mode)
    assert json.loads((tmp_path / "new.json").read_text())["kind"] == "modes"


def test_stdout_holds_the_document_only(flexstage: Command) -> None:
    ended = flexstage("analyse", "stage.toml", "--set", "parts.foot_notch.profile.radius=0.9 mm", "--mat", "out.mat", "--json", "-")
    assert ended.code == 0, ended.err
    assert ended.document["kind"] == "analyse"
    assert (
        "thickness over radius = 0.944 is above 0.8"
        in {each["where"]: each["what"] for each in ended.document["warnings"]}["parts.foot_notch"]
    )
    assert "Wrote out.mat" in ended.err


def test_json_to_a_file_leaves_the_tables_on_stdout(flexstage: Command, tmp_path: Path) -> None:
    ended = flexstage("modes", "stage.toml", "--json", "out.json")
    assert "Modes" in ended.out
    assert "Wrote out.json" in ended.err
    assert flexstage("modes", "stage.toml", "--json", "-").out == (tmp_path / "out.json").read_text()


def test_mat_holds_what_the_library_computes(flexstage: Command, tmp_path: Path) -> None:
    assert flexstage("analyse", "stage.toml", "--mat", "out.mat").code == 0
    found = loadmat(tmp_path / "out.mat", simplify_cells=True)
    stage = load(tmp_path / "stage.toml")
    model = lumped(stage)
    assert found["R_a"] == pytest.approx(ideal(stage).mapping.values)
    assert found["R_s"] == pytest.approx(ideal(stage).gauge_mapping.values)
    for name, matrix in {"K": model.stiffness_matrix, "M": model.inertia_matrix, "B": model.input_matrix, "C": model.output}.items():
        assert np.array_equal(found[name], matrix), name
    assert list(found["coordinates"]) == list(model.coordinates)
    assert list(found["inputs"]) == [channel.name for channel in model.inputs]
    assert list(found["output_units"]) == [channel.unit for channel in model.outputs]
    assert found["frequencies_hz"] == pytest.approx(modes(model).frequencies)
    first, *_ = np.atleast_1d(found["platform_modes"])  # counted from 1, as MATLAB does
    assert found["frequencies_hz"][int(first) - 1] == pytest.approx(modes(model).platform_frequencies[0])


def test_state_space_in_mat_has_the_natural_frequencies_and_the_static_gain(flexstage: Command, tmp_path: Path) -> None:
    flexstage("analyse", "stage.toml", "--mat", "out.mat", "--model", "mapped")
    found = loadmat(tmp_path / "out.mat", simplify_cells=True)
    space = found["state_space"]
    poles = np.abs(np.linalg.eigvals(space["A"])) / (2.0 * np.pi)
    assert np.unique(np.sort(poles).round(6)) == pytest.approx(np.unique(found["frequencies_hz"].round(6)), rel=1e-6)
    gain = space["D"] - space["C"] @ np.linalg.solve(space["A"], space["B"])
    static = found["C"] @ np.linalg.solve(found["K"], found["B"]) + found["D"]
    assert gain == pytest.approx(static, abs=1e-9 * np.abs(static).max())
    assert space["inputs"][0] == "B1 [m]"


def test_modes_are_seen_in_motion_as_a_page_or_as_a_glb_file(flexstage: Command, tmp_path: Path) -> None:
    for name, begin in (("seen.html", b"<!doctype html>"), ("seen.GLB", b"glTF")):
        ended = flexstage("modes", "stage.toml", "--view", name)
        assert (ended.code, ended.err) == (0, f"Wrote {name}\n")
        assert (tmp_path / name).read_bytes().startswith(begin)
    ended = flexstage("modes", "stage.toml", "--view", "seen.png")
    assert ended.code == 2
    assert "ends neither in .html nor in .glb" in ended.err
    assert not (tmp_path / "seen.png").exists()


def test_plan_is_drawn_in_every_format(flexstage: Command, tmp_path: Path) -> None:
    for ending, start in {"svg": b"<?xml", "pdf": b"%PDF", "png": b"\x89PNG"}.items():
        assert flexstage("plan", "stage.toml", "-o", f"plan.{ending}").code == 0
        assert (tmp_path / f"plan.{ending}").read_bytes().startswith(start)


@pytest.mark.parametrize("model", ["ideal", *(pytest.param(name, marks=pytest.mark.full) for name in ("mapped", "lumped"))])
def test_reports_stand_alone(flexstage: Command, tmp_path: Path, model: str) -> None:
    assert flexstage("analyse", "stage.toml", "--model", model, "--report", "report.html", "--json", "-").code == 0
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")
    assert text.rstrip().endswith("</html>")
    assert "double triangle" in text
    assert not any(mark in text for mark in ('src="http', 'href="http', "@import", "<script src"))


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("name", ["parallelogram", "tip-tilt-four", "xy-stage-floating"])
def test_stages_with_locked_or_free_motions_are_reported(flexstage: Command, tmp_path: Path, name: str) -> None:
    # By the mapped model their platform has fewer than six freedoms: no stiffness matrix, no curve of it.
    design_in(tmp_path, name)
    model = "lumped" if name == "xy-stage-floating" else "mapped"
    ended = flexstage("analyse", "stage.toml", "--model", model, "--report", "report.html")
    assert ended.code == 0, ended.err
    assert (tmp_path / "report.html").read_text(encoding="utf-8").rstrip().endswith("</html>")


WITHOUT = ["damping", "gauges", "requirements", "max_mode_frequency", "opening", "placements"]
TOLD_APART = ["gauges", "placements"]
"""What the models themselves do without in different ways; of the others the lumped model alone is tried in the quick tests."""


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    ("key", "model"),
    [
        pytest.param(key, model, marks=() if model == "lumped" or (key, model) == (TOLD_APART[0], "ideal") else pytest.mark.full)
        for key in WITHOUT
        for model in ("ideal", "mapped", "lumped")
    ],
)
def test_stages_that_lack_something_are_analysed_as_far_as_they_go(flexstage: Command, tmp_path: Path, key: str, model: str) -> None:
    design = design_in(tmp_path, "parallelogram")
    document = tomlkit.parse(design.read_text())
    document.pop(key, None)
    design.write_text(tomlkit.dumps(document))
    ended = flexstage("analyse", "stage.toml", "--model", model, "--report", "report.html", "--mat", "out.mat", "--json", "out.json")
    if (key, model) == ("placements", "mapped"):
        assert ended.code == 2  # without strokes there is no unit whose stiffness could be taken
        return
    assert ended.code == 0, ended.err
    found = json.loads((tmp_path / "out.json").read_text())
    if key == "damping" and model != "ideal":
        assert found["response"] is None
        assert "damping" in found["reasons"]["response"]
    if key == "gauges":
        assert found["mapping"]["R_s"]["rows"] == []
        assert "gauges" in found["workspace"]["reasons"]["resolution"]
    if key == "placements":
        assert found["mapping"]["R_a"] is None


@pytest.mark.usefixtures("undrawn")
def test_a_report_shows_what_was_set_and_what_that_did(flexstage: Command, tmp_path: Path) -> None:
    design_in(tmp_path, "parallelogram")
    flexstage("analyse", "stage.toml", "--set", "parts.neck.thickness=1.4mm", "--report", "set.html")
    flexstage("analyse", "stage.toml", "--report", "plain.html")
    changed, plain = ((tmp_path / name).read_text() for name in ("set.html", "plain.html"))
    section = changed.partition('<section id="changes">')[2].partition("</section>")[0]
    for text in ("parts.neck.thickness", "2 mm", "1.4 mm", "Changes of key figures", "frequency.platform.1", "old", "new", "change"):
        assert text in section, text
    assert '<section id="changes">' not in plain


def test_a_full_disk_leaves_no_folder_of_tables(flexstage: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def write_until_full(path: Path, content: bytes) -> store.PendingFile:
        if path.name.startswith("modes.twists"):
            raise refuse(str(path), "it cannot be written: No space left on device", "Free space")
        return store.write_temporary(path, content)

    monkeypatch.setattr(output, "write_temporary", write_until_full)
    before = sorted(tmp_path.iterdir())
    ended = flexstage("modes", "stage.toml", "--csv", "tables")
    assert (ended.code, "No space left" in ended.err) == (2, True)
    assert sorted(tmp_path.iterdir()) == before
