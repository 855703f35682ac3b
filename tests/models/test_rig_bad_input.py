"""What a virtual test refuses: named, with the numbers compared, all at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.finding import DesignError
from flexstage.experiment import Amplifier, AntiAlias, InputQuantity, NoiseDrive, RigSetup, Sensing
from flexstage.experiment.virtual_rig.chain import chain
from flexstage.experiment.virtual_rig.checks import range_findings
from flexstage.experiment.virtual_rig.plan import plan_test, volts_per_metre
from flexstage.mechanism.mechanism import ModalDamping
from flexstage.models.mapped import mapped

STAGE = fs.case("double-triangle")
SOUND = RigSetup(seconds=10.0)


def told(setup: RigSetup, stage: fs.Mechanism = STAGE) -> str:
    with pytest.raises(DesignError) as caught:
        fs.experiment.rig(stage, mapped(stage), setup)
    return str(caught.value)


@pytest.mark.parametrize(
    ("setup", "texts"),
    [
        (replace(SOUND, seconds=0.0), ("seconds", "0 s")),
        (replace(SOUND, seconds=-1.0), ("seconds", "-1 s")),
        (replace(SOUND, seconds=1e-3), ("seconds", "got 2: 0.001 s at 2048 Hz")),
        (replace(SOUND, seconds=1e15), ("seconds", "samples")),
        (replace(SOUND, rate=0.0), ("rate", "0 Hz")),
        (replace(SOUND, rate=-5.0), ("rate", "-5 Hz")),
        (replace(SOUND, rate=300.0), ("rate", "300 Hz is below twice the frequency of the highest platform mode, 176.7 Hz", "353.4 Hz")),
        (replace(SOUND, seed=-1), ("seed", "-1")),
        (replace(SOUND, drive=NoiseDrive(stroke=20e-6, actuators=("B2",))), ("B2", "6 x 20 um", "-75 um to 75 um", "12.5 um rms")),
        (replace(SOUND, drive=NoiseDrive(stroke=0.0)), ("drive.stroke", "0 um")),
        (replace(SOUND, drive=NoiseDrive(stroke=1e-6, voltage=1.0)), ("drive", "stroke and as a voltage")),
        (replace(SOUND, drive=NoiseDrive(actuators=("b1",))), ("actuator b1", "B1")),
        (replace(SOUND, drive=NoiseDrive(actuators=())), ("actuators", "no actuator is selected", "B6")),
        (replace(SOUND, drive=NoiseDrive(actuators=("B1", "B1"))), ("actuator B1", "2 times")),
        (replace(SOUND, drive=NoiseDrive(band=(100.0, 50.0))), ("band", "100 Hz to 50 Hz")),
        (replace(SOUND, amplifier=Amplifier(bandwidth=0.0)), ("amplifier.bandwidth", "0 Hz")),
        (replace(SOUND, amplifier=Amplifier(bandwidth=10.0, resistance=10.0)), ("amplifier", "both")),
        (replace(SOUND, amplifier=Amplifier(current=1e-3)), ("B4", "A rms exceed the amplifier's limit of 0.001 A")),
        (replace(SOUND, filter=AntiAlias(order=-1)), ("filter", "wrong order (got -1)")),
        (replace(SOUND, filter=AntiAlias(corner=0.0)), ("filter.corner", "0 Hz")),
        (replace(SOUND, sensing=Sensing(density=-1e-9)), ("sensing.density", "-1 nm/Hz^0.5")),
        (replace(SOUND, sensing=Sensing(density=1e-5)), ("S1", "half of its range, 500 um")),
        (replace(SOUND, sensing=Sensing(drift=1e-3)), ("S6", "half of its range", "Reduce the drive or the drift")),
    ],
)
def test_bad_set_ups_are_refused(setup: RigSetup, texts: tuple[str, ...]) -> None:
    message = told(setup)
    assert all(text in message for text in texts), message


def test_all_findings_are_told_together() -> None:
    message = told(RigSetup(seconds=0.0, rate=10.0, seed=-1, drive=NoiseDrive(actuators=("B9",))))
    assert [line.partition(":")[0] for line in message.splitlines()] == ["seconds", "seed", "rate", "actuator B9"]


def test_a_stage_without_gauges_records_nothing() -> None:
    assert "gauges: the stage has no gauge" in told(SOUND, replace(STAGE, gauges={}))


def test_a_stage_without_damping_is_refused() -> None:
    stage = replace(STAGE, damping=None)
    assert "the design specifies no damping" in told(SOUND, stage)
    assert "would never decay" in told(SOUND, replace(STAGE, damping=ModalDamping(0.0)))
    assert "vibrations decay too slowly" in told(SOUND, replace(STAGE, damping=ModalDamping(1e-8)))


def test_stacks_without_voltage_or_capacitance_are_named() -> None:
    parts = {
        name: replace(part, voltage_low=None, capacitance=None) if isinstance(part, fs.Piezo) else part
        for name, part in STAGE.parts.items()
    }
    stage = replace(STAGE, parts=parts)
    assert "B1: its stack has no voltage range" in told(replace(SOUND, input_quantity=InputQuantity.VOLTAGE), stage)
    assert "B6: its stack has no capacitance" in told(replace(SOUND, amplifier=Amplifier(resistance=10.0)), stage)
    assert np.isnan(volts_per_metre(next(part for part in parts.values() if isinstance(part, fs.Piezo))))
    assert plan_test(stage, mapped(stage), SOUND).length == 20_480


@pytest.mark.parametrize(("seconds", "told"), [(15.0, True), (240.0, False)])
def test_drift_fills_a_range_with_the_root_of_time(seconds: float, told: bool) -> None:
    """A walk of w per root of a minute is w sqrt(T / 60 s) after T: six times as much is compared with half of the range."""
    stage = fs.case("double-triangle")
    model = mapped(stage)
    plan = plan_test(stage, model, RigSetup(seconds=seconds, drive=NoiseDrive(stroke=1e-9, actuators=("B1",))))
    edge = 0.5 * plan.ranges / 6.0 / np.sqrt(seconds / 60.0)
    plan = replace(plan, walks=(1.1 if told else 0.9) * edge)
    found = [each for each in range_findings(plan, chain(model, plan, model.damping)) if "exceed half of its range" in each.what]
    assert len(found) == (len(plan.gauges) if told else 0)
