"""The virtual rig on stages that coils and forces drive: variances, units, identified modes and gains, loops on its records, refusals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.finding import DesignError
from flexstage.control.study.resolve import on_test, resolve
from flexstage.control.study.setup import LoopSetup
from flexstage.experiment import Amplifier, InputQuantity, NoiseDrive, RigSetup, Sensing
from flexstage.experiment.comparison import compare
from flexstage.experiment.pipeline import identification
from flexstage.experiment.updating.free import Prior
from flexstage.experiment.updating.update import update
from flexstage.experiment.virtual_rig.chain import amplitude_shape
from flexstage.experiment.virtual_rig.rig import rig, simulate_test
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped

STAGE = fs.case("z-stage")
MODEL = lumped(STAGE)
BAND = NoiseDrive(band=(0.0, 90.0))
SETUP = RigSetup(seconds=100.0, rate=256.0, drive=BAND, sensing=Sensing(density=1e-10))


def refusal(setup: RigSetup, stage: fs.Mechanism = STAGE) -> str:
    with pytest.raises(DesignError) as caught:
        rig(stage, MODEL, setup)
    return str(caught.value)


def test_variances_are_those_of_the_random_response() -> None:
    test = simulate_test(STAGE, MODEL, replace(SETUP, sensing=Sensing(density=0.0)))
    grid = np.concatenate([np.linspace(0.01, 20.0, 4000), np.linspace(20.02, 115.0, 600)])
    area = np.trapezoid(amplitude_shape(np.linspace(0.0, 128.0, 20_001), test.plan.band) ** 2, np.linspace(0.0, 128.0, 20_001))
    density = test.plan.rms[0] ** 2 * np.maximum(amplitude_shape(grid, test.plan.band) ** 2, 1e-30) / area
    expected = fs.random_response(MODEL, ("S",), {"motor": fs.Spectrum(density, grid)}, (0.01, 115.0))
    np.testing.assert_allclose(test.chain.output_rms, expected.rms, rtol=2e-3)


def test_a_record_of_forces_is_that_of_currents_times_the_force_constant() -> None:
    records = {each: rig(STAGE, MODEL, replace(SETUP, seconds=2.0, input_quantity=each)) for each in (None, InputQuantity.FORCE)}
    assert [record.channels[0].unit for record in records.values()] == ["A", "N"]
    current, force = (record.values for record in records.values())
    np.testing.assert_allclose(force[:, 0], 12.0 * current[:, 0], rtol=1e-12)
    np.testing.assert_array_equal(force[:, 1], current[:, 1])
    drives = (replace(BAND, force=0.12), replace(BAND, current=0.01))
    by_force, by_current = (simulate_test(STAGE, MODEL, replace(SETUP, drive=each)).plan.rms for each in drives)
    np.testing.assert_allclose(by_force, by_current, rtol=1e-12)


@pytest.mark.parametrize("quantity", [None, InputQuantity.FORCE])
def test_the_modes_of_the_rig_and_its_gain_are_found_in_the_record(quantity: InputQuantity | None) -> None:
    seen = identification((rig(STAGE, MODEL, replace(SETUP, input_quantity=quantity)),)).found
    found = compare(STAGE, seen)
    experiment = found.modes[0].experiment
    assert experiment is not None
    assert experiment.frequency == pytest.approx(found.modes[0].theory, rel=1e-5)
    assert experiment.damping == pytest.approx(0.01, rel=1e-3)
    assert not found.misnamed
    told = update(STAGE, seen, ("parts.leaf.thickness", "materials.aluminium.density"), Prior(gain_error=1e-3))
    np.testing.assert_allclose(told.changes, 0.0, atol=2e-3)
    assert (gain := told.residuals[-1]).unit == "m/A"
    assert gain.measured == pytest.approx(static_gain(MODEL, ("S",), ("motor",)).values[0, 0], rel=2e-3)


def test_a_loop_closes_on_the_record_of_a_coil() -> None:
    seen = identification((rig(STAGE, MODEL, SETUP),))
    theory = resolve(STAGE, LoopSetup())
    measured = on_test(theory, seen.found)
    lines = np.array([2.0, 20.0, 60.0])
    responses = [each.plant.system.sweep(lines)[:, each.plant.system.output_names.index("gap.S"), 0] for each in (theory, measured)]
    np.testing.assert_allclose(responses[1], responses[0], rtol=5e-3)


def test_what_no_coil_has_is_refused_by_name() -> None:
    assert "motor: its input is a current or force, not a stroke" in refusal(replace(SETUP, drive=replace(BAND, stroke=1e-6)))
    assert "not a voltage" in refusal(replace(SETUP, input_quantity=InputQuantity.VOLTAGE))
    assert "output resistance requires the capacitance of a stack" in refusal(replace(SETUP, amplifier=Amplifier(resistance=10.0)))
    assert "exceed the current of -4 A to 4 A" in refusal(replace(SETUP, drive=replace(BAND, current=1.0)))
    assert "exceed the sustained limit of 1.414 A" in refusal(replace(SETUP, drive=replace(BAND, current=2.0)))
    coil = STAGE.parts["coil"]
    assert isinstance(coil, fs.VoiceCoil)
    coil = replace(coil, peak_current=None, continuous_current=None, temperature_rise=None)
    bare = replace(STAGE, parts={**STAGE.parts, "coil": coil})
    assert "its sustained limit is unknown, so there is no default drive" in refusal(SETUP, bare)
    assert rig(bare, MODEL, replace(SETUP, drive=replace(BAND, current=0.01))).length == 25_600


def test_stacks_take_no_current() -> None:
    stage = fs.case("parallelogram")
    with pytest.raises(DesignError, match="the input of its stack is a stroke or a voltage"):
        rig(stage, lumped(stage), RigSetup(seconds=2.0, drive=NoiseDrive(current=0.1)))
