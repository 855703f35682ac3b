"""Repetitive control: what is left at harmonics and made worse between them by its closed form, stable wherever the modes lie."""

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.cases.registry import case
from flexstage.control.learning.learn import wanted_readings
from flexstage.control.learning.repeat import Repetition, repeat, repeater
from flexstage.control.learning.responses import readings
from flexstage.control.simulation.machine import machine
from flexstage.control.simulation.running import RunningLoop
from flexstage.control.study.checks import setup_findings
from flexstage.control.study.choices import Following
from flexstage.control.study.control import make_controller
from flexstage.control.study.resolve import resolve
from flexstage.control.study.runs import runs
from flexstage.control.study.setup import ControllerSetup, FollowSetup, GaugeSetup, LoopSetup, RasterMotion, StepMotion
from flexstage.control.systems.closed import loop
from tests.elsewhere.loops import without_limits

FOLLOW = FollowSetup(Following.REPETITIVE)


def closed_of(name, **given):
    resolved = resolve(case(name), LoopSetup(**{"controller": ControllerSetup(quick=True), **given}))
    control = make_controller(resolved, resolved.plant.coordinates.strokes)
    return resolved, control, loop(resolved.plant, control.system)


@pytest.fixture(scope="module")
def guide():
    return closed_of("parallelogram", controller=ControllerSetup(bandwidth=150.0))


def test_what_is_left_at_harmonics_and_between_them_is_the_closed_form(guide):
    """By simulation of a path of 26 lines, half of them harmonics of a period of 60.5 samples (z = 1), half between them (z = -1)."""
    given, control, closed = guide
    step, samples, lines = given.step, 121, np.arange(1, 27)
    count = 24 * samples
    rng, times = np.random.default_rng(3), np.arange(count)
    phases = rng.uniform(0.0, 2.0 * np.pi, len(lines))
    wanted = 1e-6 * np.sum(np.cos(2.0 * np.pi * np.outer(times, lines) / samples + phases) / lines, axis=1)[:, None]
    wanted *= np.clip(times / samples, 0.0, 1.0)[:, None]
    free = without_limits(machine(given.plant, control.system))
    held, asked = np.ones(1, dtype=bool), Repetition(0.5 * samples * step, slice(0, count))
    bare = RunningLoop(free, {}).advance(wanted, held).pose
    running = RunningLoop(free, {})
    poses = []

    def advance(commanded):
        poses.append(running.advance(commanded, held).pose)
        return poses[-1]

    found = repeat(advance, closed, wanted, asked)
    known = repeater(closed, asked.period, 0.6, 0.02)
    target = wanted_readings(closed, wanted, known.band.end)
    last = slice(count - 2 * samples, count - samples)
    errors = [np.fft.rfft((target - each)[last, 0])[lines] for each in (bare, np.concatenate(poses))]
    frequencies = lines / (samples * step)
    keep, teach = known.at(frequencies, step)
    z = np.where(lines % 2 == 0, 1.0, -1.0)
    right = readings(closed, frequencies)[:, 0, 0] * teach[:, 0, 0]
    share = (1.0 - keep * z) / (1.0 - (keep - right) * z)
    assert frequencies[-1] > 0.9 * known.band.end
    np.testing.assert_allclose(errors[1] / errors[0], share, rtol=0.0, atol=1e-6)
    assert np.all(np.abs(share[(lines % 2 == 0) & (frequencies < 0.6 * known.band.end)]) < 0.03)
    assert np.all(np.abs(share) <= found.amplifies * (1.0 + 1e-6))
    assert found.amplifies == pytest.approx(2.0 / 1.4, rel=0.05)  # (1 + 1)/(1 + 1 - gain) half way between harmonics


def test_it_contracts_wherever_the_modes_lie(guide):
    """On a finer grid, at offsets of its own, by the filters themselves."""
    given, _, closed = guide
    found = repeater(closed, 0.02, 0.6, 0.02)
    lines = np.linspace(2.0, 0.5 / given.step, 4001)
    keep, teach = found.at(lines, given.step)
    assert found.contraction < 0.9
    for offset in (-0.02, -0.0133, 0.0071, 0.02):
        left = keep - readings(closed, lines, offset)[:, 0, 0] * teach[:, 0, 0]
        assert np.max(np.abs(left)) < found.contraction * 1.02


def test_a_raster_is_repeated_better_and_better():
    path = RasterMotion(length=5e-6, pitch=0.5e-6, lines=10, speed=1e-3, acceleration=0.5)
    quiet = GaugeSetup(noise=1e-12, resolution=0.0)
    given, control, closed = closed_of("xy-stage", trajectory=path, gauges=quiet, follow=FOLLOW)
    (found,) = runs(given, control, closed)
    seen = found.repeated
    assert seen.rms[-1, 0] < 0.1 * seen.rms[0, 0]
    assert seen.contraction < 0.9
    assert len(seen.rms) == 4
    assert np.all(seen.beyond > 0.0)


def test_what_cannot_be_is_said(guide):
    _, _, closed = guide
    told = [str(each) for each in setup_findings(LoopSetup(trajectory=StepMotion(), follow=FOLLOW))]
    assert ["needs a periodic trajectory (got step" in each for each in told] == [True]
    with pytest.raises(DesignError, match="first harmonic"):
        repeater(closed, 6e-4, 0.6, 0.02)
    few = RasterMotion(length=5e-6, pitch=0.5e-6, lines=2, speed=1e-3, acceleration=0.5)
    with pytest.raises(DesignError, match="repetitive control needs at least 2"):
        runs(*closed_of("xy-stage", trajectory=few, follow=FOLLOW))
