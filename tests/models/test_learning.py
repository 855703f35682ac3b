"""Paths known beforehand: shapers by their closed forms, inverses that begin before the path, and learning down to what does not repeat."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from flexstage.base.finding import DesignError
from flexstage.cases.registry import case
from flexstage.control.example import integral_loop
from flexstage.control.export.files import path_file
from flexstage.control.learning.learn import LearningSettings, fade_ends, filter_path, learn, robust_band, wanted_readings
from flexstage.control.learning.responses import Band, readings, through
from flexstage.control.learning.shaper import zv, zvd
from flexstage.control.show.figures.time import lesson_figure
from flexstage.control.study.checks import setup_findings
from flexstage.control.study.choices import Axis, Following
from flexstage.control.study.control import make_controller
from flexstage.control.study.resolve import resolve
from flexstage.control.study.runs import runs
from flexstage.control.study.setup import (
    AxisAmplitudes,
    ControllerSetup,
    DampingSetup,
    FileMotion,
    FollowSetup,
    GaugeSetup,
    LoopSetup,
    RasterMotion,
    SineMotion,
    StepMotion,
)
from flexstage.control.systems.closed import loop
from flexstage.control.systems.system import select
from flexstage.show.figures.export import to_svg


def test_a_mode_that_hardly_rings_needs_no_later_impulses():
    for shaper in (zv(40.0, 0.999995), zvd(40.0, 0.999995)):
        assert len(shaper.amplitudes) == len(shaper.times)
        assert shaper.amplitudes == pytest.approx([1.0] + [0.0] * (len(shaper.times) - 1))


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.3])
def test_shapers_leave_a_mode_at_rest(damping):
    """By integration of the mode, not by their formula; a wrong frequency by its square with the derivative."""
    for shaper, order in ((zv(40.0, damping), 1), (zvd(40.0, damping), 2)):
        assert np.sum(shaper.amplitudes) == pytest.approx(1.0, rel=1e-14)

        def left(frequency, shaper=shaper):
            w = 2.0 * np.pi * frequency
            state = np.zeros(2)
            A = np.array([[0.0, 1.0], [-(w**2), -2.0 * damping * w]])
            for time, amplitude in zip(shaper.times, shaper.amplitudes, strict=True):
                state += amplitude * scipy.linalg.expm(A * (shaper.times[-1] - time)) @ np.array([-1.0, 0.0])
            return np.hypot(state[0], (state[1] + damping * w * state[0]) / (w * np.sqrt(1.0 - damping**2)))

        assert left(40.0) < 1e-13
        grown = left(40.0 * 1.002) / left(40.0 * 1.001)
        assert grown == pytest.approx(2.0**order, rel=0.01)


def test_an_antistable_inverse_runs_backward():
    """Of T = 2/z - 1, whose zero is outside: w[n+1]/2 + w[n+2]/4 + ..."""
    path = np.concatenate([np.zeros(60), np.linspace(0.0, 1.0, 30), np.ones(70)])[:, None]
    points = np.exp(2j * np.pi * np.arange(len(path) // 2 + 1) / len(path))
    found = through((1.0 / (2.0 / points - 1.0))[:, None, None], path)
    later = np.concatenate([path[1:], np.ones((60, 1))])
    wanted = sum(0.5 ** (ahead + 1) * later[ahead : ahead + len(path)] for ahead in range(50))
    assert found == pytest.approx(wanted, abs=1e-12)
    assert np.max(np.abs(found[:59])) > 1e-3  # it begins before the path does


def closed_of(name, **given):
    resolved = resolve(case(name), LoopSetup(**{"controller": ControllerSetup(quick=True), **given}))
    control = make_controller(resolved, resolved.plant.coordinates.strokes)
    return resolved, control, loop(resolved.plant, control.system)


def test_a_pass_contracts_wherever_the_modes_lie():
    """On a finer grid, at offsets of its own, by loops that are closed as a whole."""
    gain, spread = 0.6, 0.02
    _, _, closed = closed_of("parallelogram")
    found = robust_band(closed, gain, spread)
    assert 0.0 < found.contraction < 0.8
    lines = np.linspace(5.0, found.band.end, 4001)
    model, worst = readings(closed, lines), 0.0
    seen = select(closed.system, ["reference.x"], ["pose.x"]).transfer(lines)
    assert model == pytest.approx(seen, rel=1e-8)
    for offset in (-0.02, -0.0133, 0.0071, 0.0169, 0.02):
        moved = readings(closed, lines, offset)
        worst = max(worst, float(np.max(np.abs(found.band.gains(lines) * (1.0 - gain * moved / model)[:, 0, 0]))))
    assert worst < found.contraction * 1.02


def test_a_loop_too_slow_to_invert_is_told_as_such():
    """The errors contract, but the inverse of a loop that reaches 1.6 mHz amplifies 100 times and more at 0.9 Hz."""
    closed = integral_loop(gain=0.01)
    with pytest.raises(DesignError, match=r"by 0\.4\d* \(expected 0\.8 or less\), and the inverse .* by \d{3,} \(expected 100 or less\)"):
        robust_band(closed, 0.6, 0.02)


def test_a_raster_is_learned_down_to_what_does_not_repeat():
    path = RasterMotion(length=10e-6, pitch=1e-6, lines=2, speed=0.5e-3, acceleration=0.05)
    quiet = GaugeSetup(noise=1e-10, resolution=0.0)
    given, control, closed = closed_of("xy-stage", trajectory=path, gauges=quiet, follow=FollowSetup(Following.LEARNING))
    (found,) = runs(given, control, closed)
    seen = found.learned
    assert seen.contraction < 0.8
    assert np.max(seen.rms[0] / seen.noise) > 10.0
    assert np.all(seen.above_noise < 2.0)
    assert np.all(seen.beyond > 0.0)
    assert found.tracking.at("x", "true rms") < 0.3 * runs(replace(given, setup=replace(given.setup, follow=None)), control, closed)[
        0
    ].tracking.at("x", "true rms")


def test_what_does_not_repeat_is_the_noise_of_the_passes():
    """White noise of one micrometre on a pass that follows its command: unbiased by the few repeats, in the band of learning."""
    _, _, closed = closed_of("parallelogram")
    rng = np.random.default_rng(5)
    lesson = LearningSettings(passes=1, gain=0.6, spread=0.02, window=slice(1000, 9000))
    still = np.zeros((10_000, 1))
    seen = [learn(lambda path, _: path + 1e-6 * rng.standard_normal(path.shape), closed, still, lesson) for _ in range(4)]
    gains = Band(seen[0].band).gains(np.abs(np.fft.fftfreq(len(still), closed.step)))
    expected = 1e-6 * np.sqrt(np.mean(gains**2))
    assert np.sqrt(np.mean([each.noise**2 for each in seen])) == pytest.approx(expected, rel=0.03)


@pytest.mark.full
@pytest.mark.parametrize("damping", [None, DampingSetup(ratio=0.2)])
def test_the_shipped_stage_learns_a_raster_along_z(damping):
    """Within ten passes down to twice what does not repeat, in the band that is told, along all six motions."""
    path = RasterMotion(length=5e-6, pitch=1e-6, lines=6, speed=0.1e-3, acceleration=0.01, fast=Axis.Z, slow=Axis.X)
    quiet = GaugeSetup(noise=1e-10, resolution=0.0)
    given, control, closed = closed_of(
        "double-triangle", trajectory=path, gauges=quiet, follow=FollowSetup(Following.LEARNING), damping=damping
    )
    seen = runs(given, control, closed)[0].learned
    assert len(seen.rms) == 11
    assert seen.rms[0, 2] > 50.0 * seen.noise[2]
    assert np.all(seen.above_noise < 2.0)
    assert np.all(seen.beyond > 0.0)


def test_what_is_commanded_is_a_trajectory_for_others(tmp_path):
    """The path of the inverse, written and read as a trajectory, moves the platform as it did where it was found."""
    path = SineMotion(frequency=20.0, amplitude=AxisAmplitudes(x=3e-6), periods=1)
    given = {"gauges": GaugeSetup(noise=0.0, resolution=0.0), "controller": ControllerSetup(bandwidth=100.0)}
    resolved, control, closed = closed_of("parallelogram", trajectory=path, follow=FollowSetup(Following.INVERSE), **given)
    (found,) = runs(resolved, control, closed)
    written = tmp_path / "path.csv"
    written.write_text(path_file(found.commanded, resolved.step, found.simulated.coordinates))
    again = replace(resolved, setup=replace(resolved.setup, follow=None, trajectory=FileMotion(str(written))))
    (replayed,) = runs(again, control, closed)
    count = len(found.simulated.times)
    rest = (len(found.commanded) - count) // 2
    assert np.max(np.abs(found.commanded[rest : rest + count] - found.simulated.reference)) > 1e-7
    seen = replayed.simulated.pose[rest : rest + count]
    np.testing.assert_allclose(seen, found.simulated.pose, rtol=0.0, atol=1e-8 * np.max(np.abs(seen)))


@pytest.mark.parametrize(("least", "told"), [(1e-9, "0.1"), (2e-7, "0.5")])
def test_errors_by_pass_are_drawn_with_plain_numbers(least, told):
    drawn = to_svg(lesson_figure(np.geomspace(1e-6, least, 4)[:, None], ["x"], ["m"], "passes"), "lessons", "Errors by pass")
    assert f">{told}<" in drawn
    assert "mathdefault" not in drawn


def test_noise_that_begins_at_once_is_faded():
    """Without it, what a band without phase sees before the begin comes back at the end, and all between is off by as much."""
    count, window = 4000, slice(1000, 3000)
    gains = 100.0 * Band(300.0).gains(np.fft.rfftfreq(count, 1e-4))
    noise = np.random.default_rng(1).normal(size=(count, 1))
    noise[0] = 5.0
    faded = noise * fade_ends(count, window)[:, None]
    inside = filter_path(gains, faded)[window]
    assert inside == pytest.approx(np.fft.irfft(gains[:, None] * np.fft.rfft(faded, axis=0), n=count, axis=0)[window], abs=0.1)
    assert abs(np.mean(filter_path(gains, noise)[window] - inside)) > 10.0


def test_the_inverse_leaves_nothing_of_a_slow_path():
    path = SineMotion(frequency=20.0, amplitude=AxisAmplitudes(x=3e-6))
    quiet = GaugeSetup(resolution=0.0)
    plain, inverted = (
        runs(*closed_of("parallelogram", trajectory=path, gauges=quiet, follow=follow))[0].tracking.at("x", "true rms")
        for follow in (None, FollowSetup(Following.INVERSE))
    )
    assert inverted < 1e-2 * plain  # what is left is beyond the band


def test_gauges_of_a_first_order_show_the_true_path_late():
    """Of a slow cosine step, a gauge with a corner frequency shows the response of that lag."""
    corner, count = 200.0, 2000
    resolved, _, closed = closed_of("parallelogram", gauges=GaugeSetup(resolution=0.0, bandwidth=corner))
    time = np.arange(count) / resolved.rate
    path = 0.5 * (1.0 - np.cos(np.pi * np.clip((time - 0.05) / 0.04, 0.0, 1.0)))
    seen = scipy.signal.lsim(([1.0], [1.0 / (2.0 * np.pi * corner), 1.0]), U=path, T=time)[1]
    found = wanted_readings(closed, 1e-6 * path[:, None], 800.0)[:, 0]
    assert found == pytest.approx(1e-6 * seen, abs=2e-10)
    assert np.max(np.abs(seen - path)) > 0.03


def test_a_shaped_step_rings_less():
    given = {"controller": ControllerSetup(integral=900.0), "trajectory": StepMotion(amplitude=AxisAmplitudes(x=1e-6))}
    resolved, control, closed = closed_of("parallelogram", **given)
    poles = closed.system.poles
    rates = np.log(poles[np.abs(poles) > 1e-6].astype(complex)) * resolved.rate
    ring = rates[np.argmax(np.where(rates.imag > 1.0, rates.real, -np.inf))]
    follow = FollowSetup(Following.ZV, frequency=float(np.abs(ring) / (2.0 * np.pi)), damping=float(-ring.real / np.abs(ring)))
    assert follow.damping < 0.3
    shaped = closed_of("parallelogram", **given, follow=follow)
    late = [np.ptp(run.simulated.true_error[run.simulated.times > 0.01, 0]) for run in (*runs(resolved, control, closed), *runs(*shaped))]
    assert late[1] <= late[0]


def test_what_cannot_be_is_said():
    asked = [FollowSetup(Following.ZV), FollowSetup(Following.INVERSE, frequency=3.0)]
    told = [str(finding) for each in asked for finding in setup_findings(LoopSetup(follow=each))]
    assert [each.partition(":")[0] for each in told] == ["follow.frequency", "follow.frequency"]
    with pytest.raises(DesignError, match=r"must be positive \(got 0 Hz\)"):
        zv(0.0, 0.1)
