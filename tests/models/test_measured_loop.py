"""Loops designed on what a test found hold on the truth behind the test; what is read off the responses is what the truth gives there."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.control.noise import noise_budget
from flexstage.control.plant_models.electronics import sampling_chain
from flexstage.control.plant_models.plants import Plant
from flexstage.control.robustness.measured_margins import MeasuredMargins, _ends, measured_margins
from flexstage.control.robustness.stability_margins import bandwidths, peaks
from flexstage.control.simulation.machine import machine
from flexstage.control.simulation.run import simulate
from flexstage.control.study.choices import Criterion, Following
from flexstage.control.study.control import make_controller
from flexstage.control.study.resolve import on_test, resolve
from flexstage.control.study.runs import runs
from flexstage.control.study.setup import (
    AxisAmplitudes,
    ControllerSetup,
    Floor,
    FollowSetup,
    GaugeSetup,
    LoopSetup,
    SineMotion,
    VibrationSetup,
)
from flexstage.control.study.study import LoopStudy, loop_study
from flexstage.control.systems.closed import LoopBreak, loop
from flexstage.experiment.identification.identify import Search, identify
from flexstage.experiment.pipeline import Identification, identification
from flexstage.experiment.records.record import Channel, Responses, Role
from flexstage.experiment.spectral.local_responses import local_responses
from flexstage.experiment.virtual_rig.rig import rig
from flexstage.experiment.virtual_rig.setup import NoiseDrive, RigSetup, Sensing
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.frequency import superpose
from flexstage.models.linear.port import ports
from flexstage.models.lumped import lumped
from tests.conftest import FULL
from tests.elsewhere.loops import without_limits
from tests.models.synthetic_records import record, truth

COPIES = 200 if FULL else 60
SHAKEN = VibrationSetup(criterion=Criterion("VC-D"))
SETUP = LoopSetup(floor=Floor(x=SHAKEN, y=SHAKEN, z=SHAKEN), controller=ControllerSetup(quick=True))


def shaken(stage: Mechanism, seconds: float, late: float) -> Identification:
    made = RigSetup(seconds=seconds, delay=late, seed=1, drive=NoiseDrive(stroke=0.5e-6), sensing=Sensing(density=5e-10))
    return identification((rig(stage, lumped(stage), made),))


def swept(stage: Mechanism, lines: np.ndarray, late: float, *, faster: float = 1.0, noise: float = 2e-3) -> Identification:
    """Responses at uneven lines; with `faster`, those of a stage whose modes all lie by that factor higher."""
    model = lumped(stage)
    gauges = [each.name for each in model.outputs if "." not in each.name]
    assert model.damping is not None
    exact = superpose(model, ports(model, gauges, model.strokes), lines / faster, model.damping)
    lags = np.array([sampling_chain(stage).sensors[name].bandwidth for name in gauges])
    exact = exact * np.exp(-2j * np.pi * lines * late)[:, None, None] / (1.0 + 1j * lines[:, None] / lags)[:, :, None]
    draw = np.random.default_rng(2).standard_normal((2, *exact.shape))
    values = exact * (1.0 + noise * np.sqrt(0.5) * (draw[0] + 1j * draw[1]))
    outputs, inputs = (
        tuple(Channel(name, "um", role) for name in names) for names, role in ((gauges, Role.OUTPUT), (model.strokes, Role.INPUT))
    )
    return identification(Responses(lines, outputs, inputs, values))


def on_truth(truth: Plant, designed: LoopStudy, right: LoopStudy) -> None:
    """The loop designed on the test, on the truth, beside the one designed on that: the figures that are promised."""
    closed = loop(truth, designed.controller.system)
    assert closed.system.growth < 0.0
    assert peaks(closed, LoopBreak.POSE).sensitivity.value < 2.1
    assert right.bandwidths is not None
    np.testing.assert_allclose(bandwidths(closed).rejection, right.bandwidths.rejection, rtol=0.05)
    outputs = tuple(f"relative.{name}" for name in truth.coordinates.names)
    found = noise_budget(closed, right.settled.floor, (0.1, 0.5 * right.settled.rate), outputs)
    np.testing.assert_allclose(found.rms, right.noise.rms, rtol=0.05)


def compared(stage: Mechanism, test: Identification, late: float) -> LoopStudy:
    plain = loop_study(stage, SETUP)
    right = loop_study(stage, replace(SETUP, delay=plain.plant.hardware.delay + late))
    designed = loop_study(stage, SETUP, test=test)
    on_truth(right.settled.whole, designed, right)
    return designed


@cache
def recorded() -> Identification:
    return shaken(parallelogram(), 2.0, 60e-6)


def test_a_loop_designed_on_a_record_with_delay_is_the_one_of_the_truth() -> None:
    designed = compared(parallelogram(), recorded(), 60e-6)
    assert designed.measured is not None
    assert designed.settled.predicted is not None
    behind = designed.plant.hardware.delay - designed.settled.predicted.hardware.delay
    assert behind == pytest.approx(60e-6, abs=5e-6)
    own = designed.measured.loops["x"]
    for each in (own.rejection, own.phase, own.gain_high, designed.measured.peak):
        assert each.low is not None
        assert each.high is not None
        assert each.low < each.value < each.high
        assert each.low < each.fitted < each.high


def test_the_inverse_of_what_a_test_found_is_that_of_the_truth() -> None:
    """A sine of 60 Hz below a bandwidth of 100 Hz: what is left of its error is the gauge's own lag, which is told with the motion."""
    path, quiet = SineMotion(frequency=60.0, amplitude=AxisAmplitudes(x=3e-6), periods=2), GaugeSetup(noise=0.0, resolution=0.0)
    asked = LoopSetup(trajectory=path, gauges=quiet, controller=ControllerSetup(bandwidth=100.0), follow=FollowSetup(Following.INVERSE))
    given = on_test(resolve(parallelogram(), asked), recorded().found)
    control = make_controller(given, given.plant.coordinates.strokes)
    (run,) = runs(given, control, loop(given.plant, control.system))
    assert run.commanded is not None
    count = len(run.simulated.times)
    rest = (len(run.commanded) - count) // 2
    stage = resolve(parallelogram(), replace(asked, delay=160e-6, follow=None))
    known = without_limits(machine(stage.whole, control.system))
    wanted = np.concatenate([np.zeros((rest, 1)), run.simulated.reference, np.zeros((rest, 1))])
    lagged, plain = (np.std((wanted - simulate(known, each).pose)[rest : rest + count]) for each in (run.commanded, wanted))
    assert lagged < 0.01 * plain


@pytest.mark.full
def test_a_loop_designed_at_uneven_lines_is_the_one_of_the_truth() -> None:
    lines = np.geomspace(20.0, 3000.0, 500)
    designed = compared(parallelogram(), swept(parallelogram(), lines, 60e-6), 60e-6)
    assert designed.measured is not None
    assert designed.measured.peak.low is None  # the responses do not say how sure they are
    # At the lines the fitted plant is the truth's: what is read off them is what it gives there.
    assert designed.measured.peak.value == pytest.approx(designed.measured.peak.fitted, rel=0.02)


@pytest.mark.full
def test_a_loop_of_six_axes_designed_on_a_record_with_delay_is_the_one_of_the_truth() -> None:
    compared(double_triangle(), shaken(double_triangle(), 60.0, 200e-6), 200e-6)


@pytest.mark.full
def test_a_loop_of_six_axes_designed_at_uneven_lines_is_the_one_of_the_truth() -> None:
    compared(double_triangle(), swept(double_triangle(), np.geomspace(30.0, 700.0, 1500), 200e-6), 200e-6)


def test_intervals_of_margins_hold_the_truth_and_are_no_wider_than_errors_are() -> None:
    """Responses with the errors that their coherence of 0.1 states, drawn again and again: gain, phase and rejection of the loop."""
    stage, error, averages = parallelogram(), 0.01, 90_000
    lines = np.geomspace(20.0, 2000.0, 160)
    test = swept(stage, lines, 60e-6, noise=0.0)
    studied = loop_study(stage, SETUP, test=test)
    closed = loop(studied.plant, studied.controller.system)
    stored = test.found.responses
    coherence = np.full(stored.values.shape, 1.0 / (1.0 + averages * error**2))

    def read(noise: float, seed: int) -> MeasuredMargins:
        draw = np.random.default_rng(seed).standard_normal((2, *stored.values.shape)) * np.sqrt(0.5)
        values = stored.values * (1.0 + noise * (draw[0] + 1j * draw[1]))
        seen = replace(stored, values=values, coherence=coherence, averages=averages)
        return measured_margins(closed, replace(test, test=seen, found=replace(test.found, responses=seen)), studied.plant)

    exact, found = read(0.0, 0), [read(error, seed) for seed in range(COPIES)]
    for name in ("gain_high", "phase", "rejection"):
        (truth,), rows = ([getattr(margins.loops["x"], name) for margins in group] for group in ([exact], found))
        inside = np.mean([each.low <= truth.value <= each.high for each in rows])
        assert inside >= 0.95 - 3.0 * np.sqrt(0.95 * 0.05 / COPIES)
        half = 0.5 * np.mean([each.high - each.low for each in rows])
        spread = np.std([each.value for each in rows], ddof=1)
        assert 0.85 < half / (1.96 * spread) < 1.45


def test_a_margin_without_limit_has_no_interval_if_its_draws_have_limits() -> None:
    """No limit was measured, but all draws have one: an interval from infinity to infinity would claim that there is none."""
    assert np.all(np.isnan(_ends(np.inf, np.linspace(4.0, 6.0, 100))))
    assert _ends(5.0, np.linspace(4.0, 6.0, 101)) == pytest.approx((4.04, 5.96), abs=0.02)


def test_responses_of_records_are_as_far_off_as_they_say_at_resonances_too() -> None:
    known = truth((118.0, 119.4, 231.0), outputs=3, inputs=3)
    made = record(known, 5, seconds=30.0, rate=1024.0, noise=0.02)
    alone = [record(known, 6 + number, seconds=20.0, rate=1024.0, noise=0.02, active=(number,)) for number in range(3)]
    for test in ([made], [each.select([f"u{number + 1}", "y1", "y2", "y3"]) for number, each in enumerate(alone)]):
        found = identify(test, Search(band=(60.0, 400.0)))
        seen = local_responses(test, found)
        off = np.abs(seen.values - known.response(seen.frequencies))
        for low, high in ((60.0, 400.0), (117.0, 121.0), (229.0, 233.0)):
            near = (seen.frequencies > low) & (seen.frequencies < high)
            assert np.sqrt(np.mean((off[near] / seen.deviations[near]) ** 2)) == pytest.approx(1.0, abs=0.15)
        largest = np.max(np.abs(seen.values), axis=(1, 2))
        assert np.max(np.max(off, axis=(1, 2))[largest > 0.5 * np.max(largest)] / np.max(largest)) < 0.02  # H1 is 10 % off


def test_a_record_of_another_stage_is_refused() -> None:
    lines = np.geomspace(20.0, 6000.0, 300)
    with pytest.raises(DesignError, match="probably another stage"):
        loop_study(parallelogram(), SETUP, test=swept(parallelogram(), lines, 0.0, faster=1.9))
    found = swept(parallelogram(), lines, 0.0).found
    renamed = replace(found, outputs=tuple(replace(each, name=f"T{each.name}") for each in found.outputs))
    with pytest.raises(DesignError, match="no output channel in the record has this name"):
        loop_study(parallelogram(), SETUP, test=Identification(found.responses, renamed))
    volts = replace(found, inputs=tuple(replace(each, unit="V") for each in found.inputs))
    with pytest.raises(DesignError, match='got "V", expected m'):
        loop_study(parallelogram(), SETUP, test=Identification(found.responses, volts))


def test_a_record_without_a_mode_is_refused() -> None:
    found = recorded().found
    none = replace(
        found,
        frequencies=found.frequencies[:0],
        damping=found.damping[:0],
        shapes=found.shapes[:, :0],
        participation=found.participation[:0],
        close=(),
    )
    with pytest.raises(DesignError, match="no identified mode"):
        loop_study(parallelogram(), SETUP, test=replace(recorded(), found=none))


def test_a_record_without_coherence_where_the_loop_is_tuned_is_refused() -> None:
    seen = recorded()
    assert seen.multiple is not None
    lines = seen.spectra.frequencies if seen.spectra is not None else np.zeros(0)
    deaf = np.where((lines > 20.0)[:, None] & (lines < 1000.0)[:, None], 0.1, seen.multiple)
    with pytest.raises(DesignError, match=r"near the crossover \(got 10%"):
        loop_study(parallelogram(), SETUP, test=replace(seen, multiple=deaf))
