"""The command `loop`: good defaults, options heard, bad input named, nothing half-written; document, report, files for others."""

from __future__ import annotations

import json
import re
import subprocess
import unicodedata
import zipfile
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import scipy.io

from flexstage.cases.registry import CASES, case
from flexstage.control.study.file import FORMAT, load_setup
from flexstage.control.study.setup import LoopSetup
from flexstage.experiment.example import one_mode_record
from flexstage.experiment.formats.write import write
from flexstage.mechanism.store import dump
from tests.apps.command import Command, design_in

SMALL = ("--quick", "--seconds", "0.02")


@pytest.fixture
def guide(flexstage: Command, tmp_path: Path) -> Command:
    """The command in a folder whose stage is the shipped guide of one axis: quick."""
    design_in(tmp_path, "parallelogram")
    return flexstage


@pytest.mark.usefixtures("undrawn")
def test_the_loop_of_the_shipped_stage_is_closed_judged_and_told(flexstage: Command, tmp_path: Path) -> None:
    words = ("--bandwidth", "30 Hz", "--seconds", "0.05", "--full")  # without any options: docs/loop.md
    ended = flexstage("loop", "stage.toml", *words, "--json", "loop.json", "--report", "loop.html")
    assert ended.code == 0, ended.err
    document = json.loads((tmp_path / "loop.json").read_text())
    assert document["stability"]["stable"]
    assert document["growth_all_modes_per_s"] < 0.0
    assert document["plant"]["coordinates"]["names"] == ["x", "y", "z", "rx", "ry", "rz"]
    assert document["controller"]["bandwidth_hz"] == pytest.approx(30.0, rel=0.01)
    assert document["peaks"]["sensitivity"]["value"] < 2.0
    assert [run["course"]["name"] for run in document["runs"]] == ["x", "y", "z", "rx", "ry", "rz"]
    assert document["static_errors"]["lost_motion_gains"]["largest"] < 1e-9
    for title in (
        "Loop",
        "Controller",
        "Bandwidth",
        "Stability margins",
        "Steps",
        "Static errors without the loop",
        "Positioning noise, regulated",
    ):
        assert f"{title}\n" in ended.out
    page = (tmp_path / "loop.html").read_text()
    curves = (
        "Block diagram",
        "Open loops",
        "Sensitivity",
        "Poles of the closed loop",
        "Steps",
        "Contributions to the noise",
        "Noise over frequency",
    )
    assert [name for name in curves if f'aria-label="{name}' not in page] == []
    assert not re.search(r"(src|href)=.?https?:|url\(.?https?:", page)


def test_options_of_records_need_a_record_and_are_heard(guide: Command, tmp_path: Path) -> None:
    ended = guide("loop", "stage.toml", "--units", "S*=um", "--channels", "S")
    assert ended.code == 2
    assert "--units: only applies with a record" in ended.err
    assert "--channels: only applies with a record" in ended.err
    write(tmp_path / "record.h5", one_mode_record())
    ended = guide("loop", "stage.toml", "--record", "record.h5", "--units", "=um", "--accept-fault", "everything")
    assert ended.code == 2
    assert "--units =um" in ended.err
    assert "--accept-fault everything" in ended.err
    assert "Traceback" not in ended.err


SEVERAL = ("xy-stage-floating", "bridge")
"""Cases that are tried always; the others in full only."""
UNREAD = {"mirror-mount", "telescope-mount", "leaf-guide", "resonator", "quad-suspension"}
OTHERS = sorted(set(CASES) - {"double-triangle", "parallelogram"} - UNREAD)


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in SEVERAL else pytest.mark.full) for name in OTHERS])
def test_every_case_closes_or_is_refused_with_the_reason(flexstage: Command, tmp_path: Path, name: str) -> None:
    design_in(tmp_path, name)
    ended = flexstage("loop", "stage.toml", "--controller", "pi", "--json", "-", *SMALL)
    if name == "xy-stage-floating":
        assert ended.code == 2
        assert "1 actuators produce 1 of the platform's 2 ideal motions; missing: y" in ended.err
        return
    assert ended.code == 0, ended.err
    assert ended.document["stability"]["stable"]


def test_options_go_before_the_set_up_file(guide: Command, tmp_path: Path) -> None:
    (tmp_path / "loop.toml").write_text(f'format = "{FORMAT}"\nrate = "20 kHz"\nseed = 3\n[controller]\nintegral = "100 1/s"')
    document = guide(
        "loop", "stage.toml", "--setup", "loop.toml", "--rate", "12 kHz", "--amplitude", "x=2um", "--json", "-", *SMALL
    ).document
    assert document["plant"]["hardware"]["rate_hz"] == 12000.0
    assert document["setup"]["seed"] == 3
    assert document["controller"]["loops"]["x"]["law"]["integral_per_s"] == 100.0
    assert document["runs"][0]["step"]["size"] == 2e-6


def test_every_option_is_heard(guide: Command) -> None:
    said = {
        "--model": "mapped",
        "--delay": "30 us",
        "--controller": "pid",
        "--coordinates": "actuator",
        "--bandwidth": "60 Hz",
        "--max-sensitivity": "1.9",
        "--feedforward": "reference",
        "--floor": "x=VC-C",
        "--gauge-noise": "0.2 nm/Hz^0.5",
        "--resolution": "0.5 nm",
        "--trajectory": "sine",
        "--seed": "5",
    }
    words = [word for pair in said.items() for word in pair]
    ended = guide("loop", "stage.toml", *words, "--amplifier", "3 kHz", "--amplifier", "0.3 A", "--json", "-", "--seconds", "0.1")
    assert ended.code == 0, ended.err
    setup = ended.document["setup"]
    assert (setup["model"], setup["delay"], setup["compensate"], setup["seed"]) == ("mapped", 3e-5, ["reference"], 5)
    assert (setup["controller"]["kind"], setup["controller"]["coordinates"]) == ("pid", "actuator")
    assert (setup["controller"]["bandwidth"], setup["controller"]["sensitivity"]) == (60.0, 1.9)
    assert setup["floor"]["x"]["criterion"] == "VC-C"
    assert (setup["gauges"]["noise"], setup["gauges"]["resolution"]) == (2e-10, 5e-10)
    assert (setup["amplifier"]["bandwidth"], setup["amplifier"]["current"]) == (3000.0, 0.3)
    assert setup["trajectory"]["kind"] == "sine"
    assert {source["kind"] for source in ended.document["noise"]["sources"]} == {"floor", "gauge noise", "gauge rounding"}
    assert ended.document["runs"][0]["tracking"]["rows"] == ["x"]


def test_the_example_can_be_used_as_it_is(guide: Command, tmp_path: Path) -> None:
    ended = guide("loop", "stage.toml", "--example", "loop.toml")
    assert ended.code == 0
    assert "Next: flexstage loop stage.toml --setup loop.toml" in ended.err
    assert load_setup(tmp_path / "loop.toml") == LoopSetup()
    assert guide("loop", "stage.toml", "--setup", "loop.toml", *SMALL).code == 0


def test_open_loop_and_hysteresis(guide: Command) -> None:
    words = ("--controller", "none", "--hysteresis", "15 %", "--trajectory", "sine", "--amplitude", "x=3um", "--json", "-")
    bare, inverted = (guide("loop", "stage.toml", *words, *more).document for more in ((), ("--feedforward", "hysteresis")))
    assert bare["margins"] is None
    assert bare["reasons"]["margins"] == "the stage is commanded in open loop"
    stack = bare["hysteresis"]["actuators"]["B"]
    assert stack["width"] == pytest.approx(0.15, abs=1e-3)
    assert stack["rms_error_inverse"] < 0.2 * stack["rms_error"]
    without, with_ = (document["runs"][0]["tracking"]["values"][0][2] for document in (bare, inverted))
    assert with_ < 0.5 * without


def test_a_file_of_hysteresis_and_one_of_poses(guide: Command, tmp_path: Path) -> None:
    (tmp_path / "stack.toml").write_text(
        'format = "flexstage hysteresis 1"\nthresholds = ["0 V", "20 V"]\nweights = ["100 nm/V", "20 nm/V"]\nvolts = ["0 V", "100 V"]\n'
    )
    (tmp_path / "path.csv").write_text("time [ms],x [um]\n0,0\n20,1\n40,0\n")
    words = ("--quick", "--hysteresis", "stack.toml", "--trajectory", "path.csv", "--feedforward", "hysteresis", "--json", "-")
    ended = guide("loop", "stage.toml", *words)
    assert ended.code == 0, ended.err
    assert ended.document["hysteresis"]["actuators"]["B"]["rms_error_inverse"] < 1e-9  # the stack is the model: the inverse is exact
    assert ended.document["runs"][0]["course"]["name"] == "file"
    assert "Hysteresis of the stacks" in guide("loop", "stage.toml", *words[:3], *SMALL).out


def test_exports_are_there_whole(guide: Command, tmp_path: Path) -> None:
    names = ("plant.mat", "guide.c", "guide.fmu", "guide.loop.fmu")
    ended = guide("loop", "stage.toml", *SMALL, *(word for name in names for word in ("--export", name)))
    assert ended.code == 0, ended.err
    assert all(f"Wrote {name}" in ended.err for name in (*names, "guide.h"))
    plant = scipy.io.loadmat(tmp_path / "plant.mat", simplify_cells=True)
    assert plant["sampled"]["step"] == pytest.approx(1e-4)
    with zipfile.ZipFile(tmp_path / "guide.loop.fmu") as unit:
        described = unit.read("modelDescription.xml").decode()
    assert "true motions" in described
    assert "added to readings before rounding" in described
    compiled = ["cc", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-c", "guide.c", "-o", "guide.o"]
    assert subprocess.run(compiled, cwd=tmp_path, check=False).returncode == 0


def test_names_that_would_shadow_a_header_are_refused_before_anything_is_computed(guide: Command, tmp_path: Path) -> None:
    before = sorted(tmp_path.iterdir())
    names = ("math.c", "plant.mat", "fmi2.c", "2.c", "a.txt")
    ended = guide("loop", "stage.toml", *(word for name in names for word in ("--export", name)))
    assert ended.code == 2
    for text in ("math.h", "Use stage_math.c", "Use stage_fmi2.c", "Use stage_2.c", '--export a.txt: unknown ending ".txt"'):
        assert text in ended.err
    assert ended.err.count("error: ") == 4
    assert sorted(tmp_path.iterdir()) == before


def test_exports_of_one_command_are_put_all_or_none(guide: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "g.c").write_text("mine")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    compiler = tmp_path.parent / f"{tmp_path.name}-cc"
    compiler.write_text('#!/bin/sh\n[ "$1" = --version ] && echo one && exit 0\nexit 1\n')
    compiler.chmod(0o755)
    monkeypatch.setenv("CC", str(compiler))
    words = ("--export", "plant.mat", "--export", "g.c", "--json", "loop.json", "--report", "loop.html", "--export", "g.fmu")
    ended = guide("loop", "stage.toml", *SMALL, *words)
    assert ended.code == 2
    assert "cannot compile a functional mock-up unit" in ended.err
    assert "Wrote" not in ended.err
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_the_header_is_an_output_too(guide: Command, tmp_path: Path) -> None:
    (tmp_path / "taken.h").mkdir()
    ended = guide("loop", "stage.toml", "--export", "taken.c", "--export", "g.c", "--report", "g.h")
    assert ended.code == 2
    assert "taken.h cannot be written: it is a folder" in ended.err
    assert "g.h is also the output of --report" in ended.err


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("0,0\n0.01,nan", "row 2 is not finite"),
        ("0,0\n0.01,1e400", "row 2 is not finite"),
        ("0,0\n0.01,\u202e1", "\\u202e1"),
        ("0,0\n1e300,1", "wrong number of samples (got 1e+304"),
    ],
)
def test_a_trajectory_of_what_is_no_number_is_refused(guide: Command, tmp_path: Path, rows: str, message: str) -> None:
    (tmp_path / "way.csv").write_text(f"time [s],x [um]\n{rows}\n")
    before = sorted(tmp_path.iterdir())
    ended = guide("loop", "stage.toml", "--quick", "--trajectory", "way.csv", "--export", "g.c")
    assert ended.code == 2
    assert message in ended.err
    assert sorted(tmp_path.iterdir()) == before


def test_a_set_up_may_say_what_steers_and_is_refused_by_its_escape(guide: Command, tmp_path: Path) -> None:
    (tmp_path / "loop.toml").write_text(
        'format = "flexstage loop 1"\n"x\\u202e\\u001b[31m" = 1\nseed = -1\n[controller]\nbandwidth = "nan Hz"\n'
    )
    ended = guide("loop", "stage.toml", "--setup", "loop.toml")
    assert ended.code == 2
    assert "x\\u202e\\x1b[31m: unknown key" in ended.err
    assert "controller.bandwidth" in ended.err
    assert not {letter for letter in ended.err if unicodedata.category(letter) in ("Cc", "Cf")} - {"\n"}


STEERING = "a\x1b[31m\u202e\n*/ ??/ \u0085 <b> \ufffe"


def test_names_reach_exports_escaped(flexstage: Command, tmp_path: Path) -> None:
    design = case("parallelogram")
    dump(replace(design, name=STEERING), tmp_path / "stage.toml")
    names = ("plant.mat", "guide.c", "model.fmu")
    words = (word for name in names for word in ("--export", name))
    ended = flexstage("loop", "stage.toml", *SMALL, *words, "--report", "loop.html", "--json", "loop.json")
    assert ended.code == 0, ended.err
    assert "The model in model.fmu is named stage_model" in ended.err
    unit = zipfile.ZipFile(tmp_path / "model.fmu")
    ElementTree.fromstring(unit.read("modelDescription.xml"))  # noqa: S314 made by ourselves
    texts = [(tmp_path / name).read_bytes() for name in ("guide.c", "guide.h", "loop.html")]
    texts += [unit.read(name) for name in unit.namelist() if not name.startswith("binaries/")]
    for text in (each.decode() for each in texts):
        assert not {letter for letter in text if unicodedata.category(letter) in ("Cc", "Cf", "Cs")} - set("\n\t")
    compiled = ["cc", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-c", "guide.c", "-o", "guide.o"]
    assert subprocess.run(compiled, cwd=tmp_path, check=False).returncode == 0


def test_noise_is_that_of_its_simulation(guide: Command) -> None:
    words = (
        "--gauge-noise",
        "1 nm/Hz^0.5",
        "--resolution",
        "0.1nm",
        "--floor",
        "x=5 nm/Hz^0.5",
        "--bandwidth",
        "50 Hz",
        "--json",
        "-",
        *SMALL,
    )
    document = guide("loop", "stage.toml", *words).document
    simulated, budget = document["simulated_rms"], document["noise"]["rms"]
    np.testing.assert_allclose(simulated, budget, rtol=0.2)  # 5,000 samples, some hundred of them independent


BAD: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...] = (
    (("--rate", "300 Hz"), ("rate: sampling at 300 Hz", "875.4 Hz", "Use at least")),
    (("--rate", "5"), ("--rate", "unit missing")),
    (("--bandwidth", "3 kHz"), ("bandwidth: at 3000 Hz", "the highest bandwidth found is", "Hz or less")),
    (("--bandwidth", "6 kHz"), ("half the sampling rate",)),
    (("--amplitude", "x=1mm"), ("trajectory x", "beyond the strokes from", "Multiply the trajectory")),
    (("--amplitude", "z=1um"), ("trajectory z: the stage has no motion z", "x")),
    (("--amplitude", "q=1um"), ("--amplitude q=1um: must be an axis and a value", "Use x, y, z, rx, ry or rz, e.g. z=150um.")),
    (("--trajectory", "raster"), ("the stage has no motion y",)),
    (("--trajectory", "sinus"), ("sinus", "sine")),
    (("--trajectory", "nowhere.csv"), ("nowhere.csv", "file not found")),
    (("--floor", "VC-Z"), ("--floor VC-Z", "VC-A")),
    (("--feedforward", "everything"), ("--feedforward everything", "lost-motion, load, reference, hysteresis")),
    (("--feedforward", "hysteresis"), ("compensate", "the inverse model needs a hysteresis")),
    (("--hysteresis", "nowhere.toml"), ("nowhere.toml", "file not found")),
    (("--hysteresis", "80 %"), ("--hysteresis", "at most 0.5")),
    (("--model", "ideal"), ("rigid bodies have no stiffness",)),
    (
        ("--fea", "--at", "platform.x=1 mm", "--model", "mapped"),
        ("--fea: finite elements need the nominal stage", "--fea: contradicts --model mapped"),
    ),
    (("--controller", "none", "--bandwidth", "5 Hz"), ("an open loop (kind none) is not tuned",)),
    (("--controller", "pidd"), ("--controller", 'unknown value (got "pidd"). Use pid or pi.')),
    (("--controller", "fuzzy"), ("--controller", "Use pi, pid, resonant, lqg, none, ppf or pvf")),
    (("--max-sensitivity", "0.9"), ("--max-sensitivity", "greater than 1")),
    (("--seconds", "-1"), ("seconds", "greater than 0")),
    (("--seconds", "1e9"), ("seconds", "samples")),
    (("--export", "loop.xyz"), ("--export loop.xyz", ".mat", ".fmu")),
    (("--export", "path.csv"), ("--export path.csv", "the commanded path equals the trajectory")),
    (
        ("--export", "path.csv", "--tracking", "inverse"),
        ("--export path.csv", "steps of several coordinates are not one path", "--amplitude x=1um"),
    ),
    (("--setup", "nowhere.toml"), ("nowhere.toml", "file not found")),
    (("--json", "nowhere/loop.json"), ("nowhere/loop.json cannot be written",)),
)


@pytest.mark.parametrize(("arguments", "texts"), BAD)
def test_bad_input_is_named_and_nothing_written(guide: Command, tmp_path: Path, arguments: tuple[str, ...], texts: tuple[str, ...]) -> None:
    before = sorted(tmp_path.iterdir())
    ended = guide("loop", "stage.toml", "--quick", "--report", "loop.html", *arguments)
    assert ended.code == 2, ended.out
    assert all(text in ended.err for text in texts), ended.err
    assert "Traceback" not in ended.err
    assert sorted(tmp_path.iterdir()) == before
    assert not ended.out


def test_a_key_by_its_old_name_is_refused_with_the_new_one(guide: Command, tmp_path: Path) -> None:
    (tmp_path / "loop.toml").write_text(f'format = "{FORMAT}"\nreading = "mapped"\n')
    ended = guide("loop", "stage.toml", "--setup", "loop.toml")
    assert (ended.code, ended.out) == (2, "")
    assert "loop.toml:2: reading: unknown key. Use model." in ended.err


def test_an_unstable_loop_is_refused_with_what_makes_it_so(guide: Command, tmp_path: Path) -> None:
    (tmp_path / "loop.toml").write_text(f'format = "{FORMAT}"\n[controller]\nproportional = 3\nintegral = "9000 1/s"')
    ended = guide("loop", "stage.toml", "--setup", "loop.toml", "--json", "-")
    assert ended.code == 2
    assert not ended.out
    assert "unstable loop" in ended.err
    assert "grows at" in ended.err
    assert "1674 Hz" in ended.err


def test_a_stage_without_gauges_is_refused_with_the_reason(flexstage: Command, tmp_path: Path) -> None:
    from dataclasses import replace

    from flexstage.base.number import Table

    dump(replace(case("parallelogram"), gauges=Table({}), requirements=Table({})), tmp_path / "stage.toml")
    ended = flexstage("loop", "stage.toml")
    assert ended.code == 2
    assert "0 gauges measure 0 of the platform's 1 ideal motions; missing: x" in ended.err


def test_all_findings_come_at_once(guide: Command, tmp_path: Path) -> None:
    (tmp_path / "loop.toml").write_text(
        f'format = "{FORMAT}"\n\n[gauges]\nfilter_order = 3\n[controller]\nkind = "pi"\nderivative = "1 ms"'
    )
    ended = guide("loop", "stage.toml", "--setup", "loop.toml", "--rate", "5 m", "--floor", "VC-Z", "--feedforward", "x")
    assert [line.removeprefix("error: ").partition(": ")[0] for line in ended.err.splitlines()] == [
        "--feedforward x",
        "--floor VC-Z",
        "--rate",
        "gauges.filter_order",
        "controller.derivative",
    ]
