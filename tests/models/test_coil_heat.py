"""What voice coils bear over a course: i^2 R of the simulated current, by the coil's own data, and a warning above what it is held at."""

import numpy as np
import pytest

from flexstage.cases.registry import case
from flexstage.control.study.runs import CoilHeat
from flexstage.control.study.setup import AxisAmplitudes, ControllerSetup, LoopSetup, SineMotion
from flexstage.control.study.study import loop_study
from flexstage.mechanism.assembly.expand import expand


def test_heat_is_that_of_the_simulated_current():
    stage = case("voice-coil-stage")
    path = SineMotion(frequency=20.0, periods=2.0, amplitude=AxisAmplitudes(x=50e-6))
    (run,) = loop_study(stage, LoopSetup(trajectory=path, controller=ControllerSetup(bandwidth=40.0))).runs
    assert run.seconds > 1.01 * run.course.duration  # the mean includes the rest after the path, and the table says so
    assert "with the simulated rest at its end" in CoilHeat.TABLE.notes[0]
    assembly = expand(stage)
    for number, name in enumerate(assembly.thrusts):
        part, found = assembly.actuator(name), run.heat[name]
        assert found.rms == pytest.approx(np.sqrt(np.mean(run.simulated.given[:, number] ** 2)), rel=1e-12)
        assert found.power == (None if part.resistance is None else pytest.approx(found.rms**2 * part.resistance))
        told = part.resistance is not None and part.thermal_resistance is not None
        assert found.warming == (pytest.approx(found.power * part.thermal_resistance) if told else None)
        assert any("for ever" in each.what for each in run.warnings) is (found.held is not None and found.rms > found.held)
