"""The command `rig`: records in every form, the options heard, bad input named, nothing left behind when it is interrupted."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import flexstage as fs
from flexstage.experiment import Amplifier, AntiAlias, InputQuantity, InputSignal, NoiseDrive, RigSetup, Sensing
from flexstage.experiment.formats.read import read
from flexstage.experiment.records.record import Record
from flexstage.experiment.virtual_rig.samples import Simulated
from tests.apps.command import Command

SHORT = ("rig", "stage.toml", "--seconds", "2", "--model", "mapped")


def record(path: Path) -> Record:
    found = read(path)
    assert isinstance(found, Record)
    return found


@pytest.mark.parametrize("name", ["record.uff", "record.mat", "record.h5", "record.csv"])
def test_a_record_is_that_of_the_rig_in_python(flexstage: Command, tmp_path: Path, name: str) -> None:
    ended = flexstage(*SHORT, "--seed", "7", "--rate", "1kHz", "--drift", "5nm", "-o", name)
    assert ended.code == 0, ended.err
    assert f"Wrote {name}" in ended.err
    found = record(tmp_path / name)
    stage = fs.load(tmp_path / "stage.toml")
    made = fs.experiment.rig(stage, fs.mapped(stage), RigSetup(seconds=2.0, rate=1000.0, seed=7, sensing=Sensing(drift=5e-9)))
    np.testing.assert_array_equal(found.values, made.values)
    assert found.rate == 1000.0
    assert [each.name for each in found.inputs] == ["B1", "B2", "B3", "B4", "B5", "B6"]
    assert [each.name for each in found.outputs] == ["S1", "S2", "S3", "S4", "S5", "S6"]
    assert found.name.startswith("rig: seed 7; modal damping 0.01; double triangle")


def test_every_option_is_heard(flexstage: Command, tmp_path: Path) -> None:
    options = {
        "--drive-rms": "2V",
        "--band": ("10 Hz", "400 Hz"),
        "--filter-order": "4",
        "--filter-corner": "500 Hz",
        "--gauge-noise": "0.1 nm/Hz^0.5",
        "--resolution": "1 nm",
        "--input-signal": "command",
        "--input-quantity": "voltage",
        "--rate": "2 kHz",
    }
    words = [word for key, value in options.items() for word in (key, *((value,) if isinstance(value, str) else value))]
    several = ("--actuator", "B1", "--actuator", "B5", "--amplifier", "1kohm", "--amplifier", "0.1 A")
    ended = flexstage(*SHORT, *words, *several, "-o", "record.h5")
    assert ended.code == 0, ended.err
    stage = fs.load(tmp_path / "stage.toml")
    setup = RigSetup(
        seconds=2.0,
        rate=2000.0,
        drive=NoiseDrive(voltage=2.0, band=(10.0, 400.0), actuators=("B1", "B5")),
        amplifier=Amplifier(resistance=1000.0, current=0.1),
        filter=AntiAlias(4, 500.0),
        sensing=Sensing(density=1e-10, resolution=1e-9),
        input_signal=InputSignal.COMMAND,
        input_quantity=InputQuantity.VOLTAGE,
    )
    np.testing.assert_array_equal(record(tmp_path / "record.h5").values, fs.experiment.rig(stage, fs.mapped(stage), setup).values)
    assert "lowest bandwidth of amplifiers and gauges 122.4 Hz" in " ".join(ended.out.split())


def test_the_table_gives_the_rms_to_expect(flexstage: Command, tmp_path: Path) -> None:
    ended = flexstage("rig", "stage.toml", "--seconds", "60", "--model", "mapped", "-o", "record.h5")
    (line,) = (line.split() for line in ended.out.splitlines() if line.split()[:1] == ["S4"])
    assert line[1:3] == ["output", "um"]
    found = np.std(record(tmp_path / "record.h5").select(["S4"]).values)
    assert float(line[3]) == pytest.approx(found, rel=0.05)


@pytest.mark.parametrize(
    ("arguments", "texts"),
    [
        (("--seconds", "0"), ("seconds", "0 s")),
        (("--seconds", "-3"), ("seconds", "-3 s")),
        (("--rate", "0 Hz"), ("rate", "0 Hz")),
        (("--rate", "300 Hz"), ("300 Hz", "below twice the frequency of the highest platform mode, 176.7 Hz")),
        (("--rate", "300"), ("--rate", "unit missing")),
        (("--drive-rms", "50um"), ("B1", "6 x 50 um", "-75 um to 75 um")),
        (("--drive-rms", "1kg"), ("--drive-rms", "displacement", "voltage")),
        (("--actuator", "B11"), ("actuator B11", "B1")),
        (("--amplifier", "5 s"), ("--amplifier", "frequency", "resistance", "current")),
        (("--band", "100 Hz", "50 Hz"), ("band", "100 Hz to 50 Hz")),
        (("--gauge-noise", "1 nm"), ("--gauge-noise", "noise density")),
        (("--drift", "2"), ("--drift", "unit missing")),
        (("--model", "ideal"), ("--model ideal", "no modes")),
        (("--input-signal", "both"), ("--input-signal", "must be monitor or command (got both)")),
        (("-o", "record.xyz"), ("record.xyz", ".uff")),
        (("-o", "nowhere/record.uff"), ("nowhere/record.uff cannot be written", "folder nowhere not found")),
        (("-o", "stage.toml"), ("also an input of this command",)),
    ],
)
def test_bad_input_is_named_and_nothing_written(
    flexstage: Command, tmp_path: Path, arguments: tuple[str, ...], texts: tuple[str, ...]
) -> None:
    ended = flexstage(*SHORT, "-o", "record.uff", *arguments)
    assert ended.code == 2
    assert ended.out == ""
    assert all(text in ended.err for text in texts), ended.err
    assert "Traceback" not in ended.err
    assert [path.name for path in tmp_path.iterdir()] == ["stage.toml"]


def test_all_that_is_wrong_is_told_at_once(flexstage: Command) -> None:
    ended = flexstage(*SHORT, "-o", "record.uff", "--drive-rms", "1kg", "--rate", "fast", "--drift", "2")
    assert [line.split(": ")[:2] for line in ended.err.splitlines()] == [["error", name] for name in ("--rate", "--drive-rms", "--drift")]
    ended = flexstage("rig", "stage.toml", "-o", "record.uff", "--seconds", "0", "--rate", "10 Hz", "--actuator", "B9")
    assert [line.split(": ")[:2] for line in ended.err.splitlines()] == [["error", name] for name in ("seconds", "rate", "actuator B9")]


@pytest.mark.parametrize("name", ["record.uff", "record.mat", "record.h5", "record.csv"])
def test_an_interrupted_test_leaves_nothing(flexstage: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    computed = Simulated._compute_block

    def interrupted(self: Simulated, number: int) -> object:
        if number == 2:
            raise KeyboardInterrupt
        return computed(self, number)

    (tmp_path / name).write_text("old")
    monkeypatch.setattr(Simulated, "_compute_block", interrupted)
    ended = flexstage("rig", "stage.toml", "--seconds", "60", "--model", "mapped", "-o", name)
    assert ended.code == 130
    assert ended.err.startswith("Interrupted. Nothing was written.")
    assert (tmp_path / name).read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([name, "stage.toml"])


UPRIGHT = """
format = "flexstage 1"
name = "upright"
damping = { law = "modal", ratio = 0.01 }
max_mode_frequency = "100 Hz"
materials.steel = { young = "195 GPa", poisson = 0.3, density = "7900 kg/m^3", yield_stress = "1200 MPa" }
parts.leaf = { kind = "leaf", material = "steel", length = "60 mm", thickness = "0.4 mm", width = "12 mm" }
bodies.platform.mass = "400 g"
bodies.platform.centre = ["0 mm", "0 mm", "70 mm"]
bodies.platform.inertia = { xx = "1e-4 kg m^2", yy = "1e-4 kg m^2", zz = "1e-4 kg m^2" }
[parts.coil]
kind = "voice_coil"
force_constant = "4 N/A"
peak_current = "2 A"
continuous_current = "0.5 A"
resistance = "6 ohm"
mass = "1 g"
magnet_mass = "40 g"
travel = "2 mm"
[links]
left = { joins = ["ground", "platform"], part = "leaf", at = ["-25 mm", "0 mm", "30 mm"], along = "z", bends = "y" }
right = { joins = ["ground", "platform"], part = "leaf", at = ["25 mm", "0 mm", "30 mm"], along = "z", bends = "y" }
drive = { joins = ["ground", "platform"], part = "coil", at = ["-50 mm", "0 mm", "67 mm"], along = "x" }
[sensors.scale]
kind = "encoder"
range = "10 mm"
period = "20 um"
steps = 4000
[gauges.S]
gauge = "scale"
body = "platform"
pose = { at = ["0 mm", "-15 mm", "67 mm"], along = "x" }
"""


def test_a_significant_load_is_in_the_record_and_in_theory(flexstage: Command, tmp_path: Path) -> None:
    """The weight lowers the first frequency by 3 %: record, comparison and `modes` have the lower one."""
    (tmp_path / "upright.toml").write_text(UPRIGHT)
    stage = fs.load(tmp_path / "upright.toml")
    loaded = fs.analyse(stage).modes.frequencies[0]
    assert loaded < 0.98 * fs.modes(fs.lumped(stage)).frequencies[0]
    ended = flexstage("rig", "upright.toml", "-o", "r.h5", "--seconds", "60", "--rate", "400 Hz")
    assert "are for the loaded stage" in ended.out
    found = flexstage("compare", "upright.toml", "--record", "r.h5", "--json", "c.json")
    assert "are for the loaded stage" in found.out
    mode = json.loads((tmp_path / "c.json").read_text())["modes"][0]
    assert mode["theory_hz"] == pytest.approx(loaded, rel=1e-9)
    assert mode["experiment"]["frequency_hz"] == pytest.approx(loaded, rel=1e-3)
    ended = flexstage("update", "upright.toml", "--parameters", "steel.young", "--record", "r.h5", "-o", "u.toml", "--json", "u.json")
    assert "the update uses the unloaded stage, but weight, payloads and forces change" in ended.err
    updated = json.loads((tmp_path / "u.json").read_text())
    nominal = fs.modes(fs.lumped(fs.load(tmp_path / "u.toml"))).frequencies[0]
    assert updated["compared"]["modes"][0]["theory_hz"] == pytest.approx(nominal, rel=1e-6)
