"""The set-up file of a loop: its example holds, every key of it can be used, and what is wrong is told with file, line and key."""

from __future__ import annotations

import dataclasses
import re
import tomllib

import pytest

from flexstage.base.finding import DesignError
from flexstage.control.study.checks import setup_findings
from flexstage.control.study.choices import Axes, Compensation, ControllerKind, Criterion
from flexstage.control.study.file import FORMAT, example, load_setup, loads_setup, setup_schema
from flexstage.control.study.setup import FileMotion, LoopNumbers, LoopSetup, NotchSetup, PrefilterSetup, RasterMotion, VibrationSetup
from flexstage.mechanism.store import schema
from tests.roundtrip.test_schema import Rules

_HIDDEN = re.compile(r"# (?P<line>(?:\[\w+\]|\w+ = .*))$")


def test_the_example_is_the_default() -> None:
    assert loads_setup(example()) == LoopSetup()


def test_the_example_shows_every_key() -> None:
    properties = [("", setup_schema()), *setup_schema()["$defs"].items()]
    keys = {key for _, node in properties for key in node.get("properties", {})} - {"tags", "ry", "rx", "y", "z"}
    assert not [key for key in keys if not re.search(rf"\b{key}\b", example())]


def test_every_line_of_the_example_can_be_used() -> None:
    lines, table = example().splitlines(), ""
    used = 0
    for number, line in enumerate(lines):
        hidden = _HIDDEN.match(line.partition("   #")[0].rstrip())
        table = line if line.startswith("[") else table
        if hidden is None or hidden["line"].startswith("kind") or hidden["line"].startswith("["):
            continue
        text = "\n".join([*lines[:number], line.removeprefix("# "), *lines[number + 1 :]])
        if table == "[trajectory]":
            kinds = [each for each in lines[:number] if each.startswith(("kind", "# kind"))]
            text = _with_trajectory(text, kinds[-1].removeprefix("# "), line.removeprefix("# "))
        if hidden["line"].startswith(('file = "stack', "width", "plant", "creep")):
            text = text.replace("# [hysteresis]", "[hysteresis]")
        assert Rules(setup_schema()).fits(tomllib.loads(text), setup_schema()), line
        assert loads_setup(text) != LoopSetup() or "absent: 10 kHz" in line, line
        used += 1
    assert used > 30


def _with_trajectory(text: str, kind: str, line: str) -> str:
    return f"{text.partition('[trajectory]')[0]}[trajectory]\n{kind}\n{line}\n" + (
        'file = "a.csv"\n' if '"file"' in kind and "file =" not in line else ""
    )


def test_a_full_file_means_what_it_says() -> None:
    found = loads_setup(f"""
format = "{FORMAT}"
rate = "5 kHz"
delay = "50 us"
compensate = ["load", "hysteresis"]
floor = {{ x = {{ criterion = "VC-D" }}, z = {{ frequencies = ["1 Hz", "10 Hz"], velocity = ["1 um/s/Hz^0.5", "0.1 um/s/Hz^0.5"] }} }}
hysteresis = {{ file = "stack.json" }}
[controller]
kind = "pid"
coordinates = "modal"
bandwidth = "25 Hz"
notches = [{{ frequency = "106 Hz" }}]
[trajectory]
kind = "raster"
lines = 5
""")
    assert (found.rate, found.delay) == (5000.0, 50e-6)
    assert found.compensate == (Compensation.LOAD, Compensation.HYSTERESIS)
    assert found.floor.x == VibrationSetup(criterion=Criterion.VC_D)
    assert found.floor.z == VibrationSetup(frequencies=(1.0, 10.0), velocity=(1e-6, 1e-7))
    assert (found.controller.kind, found.controller.coordinates) == (ControllerKind.PID, Axes.MODAL)
    assert found.controller.notches == (NotchSetup(106.0),)
    assert found.trajectory == RasterMotion(lines=5)
    assert not list(setup_findings(found))


def test_numbers_of_single_loops_mean_what_they_say() -> None:
    found = loads_setup(f"""
format = "{FORMAT}"
[controller]
integral = "300 1/s"
[[controller.loops]]
axes = ["x", "y"]
proportional = 4.85
notches = [{{ frequency = "103.5 Hz", depth = 0.0409, damping = 2.37 }}]
prefilter = {{ frequency = "93 Hz", lead = "208 Hz" }}
""").controller
    notch, prefilter = NotchSetup(103.5, 0.0409, 2.37), PrefilterSetup(93.0, 1.0, 208.0)
    assert found.loops == (LoopNumbers(("x", "y"), proportional=4.85, notches=(notch,), prefilter=prefilter),)
    assert found.stated == ("proportional", "integral")


def test_all_findings_come_at_once_with_file_line_and_key(tmp_path) -> None:
    path = tmp_path / "loop.toml"
    path.write_text(f"""format = "{FORMAT}"
rate = 5000
seed = 1.5

[controller]
kind = "pidd"
bandwidth = "-3 Hz"
notches = [{{ depth = 0.1 }}]

[trajectory]
kind = "steps"
[gages]
""")
    with pytest.raises(DesignError) as caught:
        load_setup(path)
    told = [str(each).removeprefix(str(tmp_path) + "/") for each in caught.value.findings]
    assert told[0].startswith("loop.toml:2: rate: unit missing (got 5000)")
    assert told[1].startswith("loop.toml:3: seed: must be a whole number (got 1.5)")
    assert any(each.startswith('loop.toml:6: controller.kind: unknown value (got "pidd")') for each in told)
    assert any(":8: controller.notches.1: frequency missing" in each for each in told)
    assert any(each.startswith('loop.toml:11: trajectory.kind: unknown kind (got "steps"). Use step') for each in told)
    assert any(each.startswith("loop.toml:12: gages: unknown key. Use gauges") for each in told)


def test_numbers_out_of_bounds_are_found() -> None:
    with pytest.raises(DesignError, match=r":3: controller.bandwidth: must be greater than 0 Hz \(got -3 Hz\)"):
        loads_setup(f'format = "{FORMAT}"\n[controller]\nbandwidth = "-3 Hz"')
    with pytest.raises(DesignError, match=r"controller.notches.1.frequency: must be greater than 0 Hz"):
        loads_setup(f'format = "{FORMAT}"\n[controller]\nnotches = [{{ frequency = "0 Hz" }}]')


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('[amplifier]\nbandwidth = "1 kHz"\nresistance = "50 ohm"', "bandwidth and resistance are both specified"),
        ("[gauges]\nfilter_order = 4", "no corner"),
        ('[gauges]\nfilter_corner = "1 kHz"', "filter_order 0 means no filter"),
        ("[floor]\nx = {}", "no amplitude is specified"),
        ('[floor]\nx = { criterion = "VC-A", velocity = ["1 um/s/Hz^0.5"] }', "criterion and velocity"),
        ('[floor]\nx = { criterion = "VC-A", frequencies = ["1 Hz"] }', "determines the frequencies"),
        ('[floor]\nx = { frequencies = ["9 Hz", "1 Hz"], velocity = ["1 um/s/Hz^0.5"] }', "got 1, expected 2"),
        ('[floor]\nx = { frequencies = ["9 Hz", "1 Hz"], velocity = ["1 um/s/Hz^0.5", "1 um/s/Hz^0.5"] }', "frequencies must increase"),
        ('[floor]\nx = { frequencies = ["1 Hz", "2 Hz"], velocity = ["0 um/s/Hz^0.5", "1 um/s/Hz^0.5"] }', "density is zero"),
        ('[controller]\nbandwidth = "20 Hz"\nintegral = "3 1/s"', "gains (integral) and tuning requirements (bandwidth) exclude"),
        ('[controller]\nderivative = "1 ms"', "kind pi has no derivative gain"),
        ('[controller]\nkind = "lqg"\nproportional = 1', "kind lqg has no proportional gain"),
        ('[controller]\nkind = "none"\nbandwidth = "20 Hz"', "an open loop (kind none) is not tuned"),
        ('[controller]\nloops = [{ axes = ["x"], integral = "3 1/s" }, { axes = ["z", "x"], integral = "3 1/s" }]', "x occurs 2 times"),
        ('[controller]\nloops = [{ axes = [], integral = "3 1/s" }]', "an entry has no axes"),
        ('[controller]\nloops = [{ axes = ["x"] }]', "loops are specified without gains"),
        ('[controller]\nsensitivity = 2\nloops = [{ axes = ["x"], integral = "3 1/s" }]', "tuning requirements (sensitivity)"),
        ('[controller]\nloops = [{ axes = ["x"], derivative = "3 ms" }]', "kind pi has no derivative gain"),
        ('[controller]\nkind = "pid"\nloops = [{ axes = ["x"], derivative = "3 ms" }]', "the derivative needs a low-pass filter"),
        ('[controller]\nprefilter = { frequency = "90 Hz" }', "a prefilter needs specified gains"),
        ('compensate = ["hysteresis"]', "the inverse model needs a hysteresis"),
        ('compensate = ["load", "load"]', "occurs 2 times"),
        ('[trajectory]\nkind = "raster"\nfast = "y"', "both axes are y"),
        ('[trajectory]\nkind = "spiral"\nfirst = "y"', "both axes are y"),
        ('[trajectory]\nkind = "step"\nspeed = "1 mm/s"', "acceleration and jerk missing"),
    ],
)  # fmt: skip
def test_contradictions_are_found(text: str, told: str) -> None:
    found = [str(each) for each in setup_findings(loads_setup(f'format = "{FORMAT}"\n{text}'))]
    assert any(told in each for each in found), found


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[amplifier]\nbits = 64", "bits: must be 1 to 32 (got 64)"),
        ("[gauges]\nfilter_order = 99", "gauges.filter_order: must be 0 to 20 (got 99)"),
        ("seed = -1", "seed: must be 0 or more (got -1)"),
        ('[trajectory]\nkind = "raster"\nlines = 0', "lines: must be 1 to 100000 (got 0)"),
        ("modes = 0", "modes: must be 1 or more (got 0)"),
        ('follow = { method = "learning", passes = 0 }', "follow.passes: must be 1 to 50 (got 0)"),
        ("damping = { order = 3 }", "damping.order: must be 1 to 2 (got 3)"),
    ],
)
def test_whole_numbers_are_bounded(text: str, told: str) -> None:
    with pytest.raises(DesignError) as caught:
        loads_setup(f'format = "{FORMAT}"\n{text}')
    assert told in str(caught.value)


def test_files_are_looked_for_from_the_set_up(tmp_path) -> None:
    path = tmp_path / "loop.toml"
    path.write_text(f'format = "{FORMAT}"\n[hysteresis]\nfile = "stack.json"\n[trajectory]\nkind = "file"\nfile = "paths/a.csv"')
    found = load_setup(path)
    assert found.hysteresis is not None
    assert found.hysteresis.file == str(tmp_path.resolve() / "stack.json")
    assert found.trajectory == FileMotion(str(tmp_path.resolve() / "paths/a.csv"))


def test_the_schema_refuses_what_the_reader_refuses() -> None:
    rules = Rules(setup_schema())
    for text in ("rate = 5", 'floor = "VC-D"', '[controller]\nkind = "pidd"', '[trajectory]\nkind = "file"', "seed = 1.5"):
        raw = tomllib.loads(f'format = "{FORMAT}"\n{text}')
        assert not rules.fits(raw, setup_schema()), text
        with pytest.raises(DesignError):
            loads_setup(f'format = "{FORMAT}"\n{text}')


def test_every_class_of_the_set_up_is_frozen() -> None:
    assert dataclasses.is_dataclass(LoopSetup)
    with pytest.raises(dataclasses.FrozenInstanceError):
        LoopSetup().rate = 3.0  # type: ignore[misc]
    assert schema()["title"] == "flexstage design"
