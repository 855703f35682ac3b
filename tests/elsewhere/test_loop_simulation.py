"""The simulated loop against other programs' answers: scipy's difference equations, scipy's integration of the continuous plant."""

from __future__ import annotations

import os
from collections.abc import Mapping

import numpy as np
import pytest
import scipy

from flexstage.control.simulation.machine import machine
from flexstage.control.simulation.result import Simulated
from flexstage.control.simulation.run import simulate
from flexstage.models.linear.model import Channel
from tests.elsewhere.independent_loop import Stepped, integrated
from tests.elsewhere.loops import RATE, full_loop, six_axes, way, without_limits

KINDS = ("pose", "command", "asked", "given", "stroke", "readings", "motions")
COUNT = 1500 if os.environ.get("FLEXSTAGE_TESTS") == "full" else 200


def worst(found: Simulated, expected: Mapping[str, np.ndarray] | Simulated) -> dict[str, float]:
    """Largest difference of each kind of series, over the largest value of columns with the same unit."""
    result = {}
    for kind in KINDS:
        ours = getattr(found, kind)
        theirs = getattr(expected, kind) if isinstance(expected, Simulated) else expected[kind]
        channels = {"pose": found.coordinates, "motions": found.channels}.get(kind, (Channel("", "m"),) * ours.shape[1])
        for unit in {channel.unit for channel in channels}:
            columns = [index for index, channel in enumerate(channels) if channel.unit == unit]
            scale = np.max(np.abs(theirs[:, columns]))
            result[f"{kind} [{unit}]"] = float(np.max(np.abs(ours[:, columns] - theirs[:, columns])) / scale)
    return result


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference over the largest value of each column's kind."""
    scale = np.maximum(np.max(np.abs(expected), axis=0), 1e-12)
    return float(np.max(np.abs(found - expected) / scale))


@pytest.mark.parametrize("delay", [0.0, 80e-6, 100e-6, 230e-6])
def test_linear_loops_equal_scipys_difference_equations(delay):
    wired = six_axes(delay=delay)
    given = without_limits(machine(wired.plant, wired.controller))
    count, random = 1500, np.random.default_rng(5)
    inputs = 1e-6 * np.cumsum(random.standard_normal((count, len(wired.system.inputs))), axis=0)
    named = dict(zip(wired.system.input_names, inputs.T, strict=True))
    reference = np.stack([named.pop(f"reference.{name}") for name in given.names], axis=-1)
    found = simulate(given, reference, named)
    system = wired.system
    _, expected, _ = scipy.signal.dlsim((system.A, system.B, system.C, system.D, 1.0 / RATE), inputs)
    wanted = dict(zip(system.output_names, expected.T, strict=True))
    for channel, series in zip(found.channels, found.motions.T, strict=True):
        assert relative(series, wanted[channel.name]) < 1e-12, channel.name
    for kind, series in (("pose", found.pose), ("error", found.error)):
        for name, column in zip(given.names, series.T, strict=True):
            assert relative(column, wanted[f"{kind}.{name}"]) < 1e-12
    for index, name in enumerate(given.actuators):
        assert relative(found.command[:, index], wanted[f"command.{name}"]) < 1e-12
        assert relative(found.stroke[:, index], wanted[name]) < 1e-12
    for index, name in enumerate(given.gauges):
        assert relative(found.readings[:, index], wanted[name]) < 1e-12


@pytest.mark.parametrize("inverse", [False, True], ids=["hysteresis", "inverse"])
def test_nonlinear_loops_equal_variable_steps_of_the_continuous_plant(inverse):
    given = full_loop(inverse=inverse)
    reference, disturbances = way(given, COUNT)
    found = simulate(given, reference, disturbances)
    assert np.any(found.slewing > 0.01)  # the limits take part
    expected = integrated(given, six_axes(current=0.02).plant, reference, disturbances)
    assert max(worst(found, expected).values()) < 1e-9, worst(found, expected)


def test_nonlinear_loops_equal_python_control():
    control = pytest.importorskip("control")
    given = full_loop()
    reference, _ = way(given, COUNT)
    found, loop = simulate(given, reference), Stepped(given)
    system = control.nlsys(loop.update, loop.output, inputs=6, outputs=12, states=len(loop.initial), dt=given.step)
    answer = control.input_output_response(system, found.times, reference.T, loop.initial)
    for ours, theirs in ((found.pose, answer.outputs[:6].T), (found.given, answer.outputs[6:].T)):
        assert np.max(np.abs(ours - theirs)) < 1e-12 * np.max(np.abs(theirs))
