"""Hysteresis identified and undone, against plants of another kind; creep against its closed forms."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.control.hysteresis.branches import branches_of
from flexstage.control.hysteresis.creep import Creep, LogCreep, exponentials
from flexstage.control.hysteresis.creep_record import identify_creep
from flexstage.control.hysteresis.identify import identify_hysteresis
from flexstage.control.hysteresis.models.bouc_wen import bouc_wen
from flexstage.control.hysteresis.models.envelope import Envelope, straight
from flexstage.control.hysteresis.models.inverse import inverse
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.hysteresis.models.scaled import scale_to_stacks
from flexstage.control.hysteresis.models.shape import major_loop
from flexstage.control.hysteresis.stack_test import StackTest, stack_test
from flexstage.experiment.records.record import Channel as RecordChannel
from flexstage.experiment.records.record import in_memory
from flexstage.models.linear.model import Channel
from tests.laws.preisach import preisach

RANGE = (0.0, 1000.0)
STROKE = 150e-6
INWARD = [0, 1000, 0, 1000, 0, 1000, 100, 900, 200, 800, 300, 700, 400, 600, 500, 1000, 0, 700, 0, 400, 0, 1000]
FROM_BOTH_ENDS = [*INWARD[:2], 0, 1000, *INWARD[6:], 300, 1000, 600, 1000, 0]


def legs(points, samples=30):
    pieces = [np.linspace(start, stop, samples + 1)[1:] for start, stop in pairwise(points)]
    return np.concatenate([np.array(points[:1], dtype=float), *pieces])


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def trajectories():
    """Wanted strokes as parts of the range, from the end of a cycle over all of it: none is like the training record."""
    time = np.linspace(0.0, 1.0, 400)
    return {
        "sine": 0.5 + 0.4 * np.sin(10.0 * np.pi * time),
        "beat": 0.5 + 0.45 * np.sin(18.0 * np.pi * time) * np.sin(np.pi * time),
        "two sines": 0.5 + 0.3 * np.sin(6.0 * np.pi * time) + 0.15 * np.sin(22.6 * np.pi * time),
        "raster": 0.5 + 0.4 * (2.0 * np.abs(2.0 * (6.0 * time % 1.0) - 1.0) - 1.0),
    }


def tracking_errors(plant, found):
    """Open-loop rms errors over the stroke, with the straight line through the record as feed-forward and with the inverse."""
    line = np.polyfit(found.strokes[found.known_from :], found.volts[found.known_from :], 1)
    undone = inverse(found.model)
    low, lead = np.min(found.strokes), legs([0.0, 1.0, 0.0, 0.5], 40)
    for name, shape in trajectories().items():
        wanted = low + found.stroke * np.concatenate([lead, shape])
        errors = [rms((plant.run(volts) - wanted)[len(lead) :]) / found.stroke for volts in (np.polyval(line, wanted), undone.run(wanted))]
        yield name, errors


@cache
def identified_bouc_wen(sharpness, skew):
    """A plant, and what is identified from its record."""
    volts = legs(INWARD)
    plant = bouc_wen(STROKE, RANGE, 0.15, sharpness=sharpness, skew=skew)
    return plant, identify_hysteresis(volts, plant.run(volts))


@pytest.mark.parametrize(("sharpness", "skew"), [(2.0, 0.0), (3.0, 0.0), (3.0, 1.0)])
def test_bouc_wen_is_identified(sharpness, skew):
    """Loop width 15 %: below 1.5 % rms of the stroke, also where the Bouc-Wen model is least like plays."""
    _, found = identified_bouc_wen(sharpness, skew)
    assert found.rms < 0.015
    assert found.validation < 1.3 * found.rms
    assert found.width == pytest.approx(0.15, abs=0.003)


@pytest.mark.parametrize("plant", [bouc_wen(STROKE, RANGE, 0.15), preisach(STROKE, RANGE, 0.15)], ids=["Bouc-Wen", "Preisach"])
def test_the_inverse_as_feed_forward_tracks_five_times_better(plant):
    volts = legs(FROM_BOTH_ENDS)
    found = identify_hysteresis(volts, plant.run(volts))
    assert found.rms < 0.005
    for name, (without, with_inverse) in tracking_errors(plant, found):
        assert without > 0.03, name
        assert with_inverse < 0.2 * without, name


def test_a_blunt_bouc_wen_plant_is_tracked_better_but_not_everywhere_five_times():
    """Its inner loops do not close, which plays cannot follow: what is left says so."""
    errors = dict(tracking_errors(*identified_bouc_wen(3.0, 0.0)))
    assert errors["sine"][1] < 0.2 * errors["sine"][0]
    assert errors["raster"][1] < 0.2 * errors["raster"][0]
    assert all(with_inverse < 0.4 * without for without, with_inverse in errors.values())


def test_a_model_is_found_again():
    """From its own record, exactly: thresholds, weights, envelope and offset."""
    bend = Envelope([0.0, 250.0, 500.0, 750.0, 1000.0], [0.0, 300.0, 550.0, 780.0, 1000.0])
    weights = np.array([100.0, 10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 3.0]) * 1e-9
    model = PrandtlIshlinskii(50.0 * np.arange(8), weights, bend, straight([1.0], 3e-6))
    volts = legs(INWARD)
    found = identify_hysteresis(volts, model.run(volts))
    assert found.rms < 1e-9
    assert found.model.weights[0] == pytest.approx(weights, rel=1e-5)
    assert found.model.before.values[0] == pytest.approx(bend.values[0], abs=1e-3)
    fresh = legs([0, 730, 20, 980, 455, 1000, 0], 40)
    assert rms(found.model.run(fresh) - model.run(fresh)) < 1e-8 * STROKE


@pytest.mark.parametrize(("volt", "per_volt", "metre", "per_metre"), [("kV", 1e-3, "nm", 1e9), ("mV", 1e3, "mm", 1e3)])
def test_units_of_a_record_decide_nothing(volt, per_volt, metre, per_metre):
    volts = 500.0 * (1.0 - np.cos(np.linspace(0.0, 6.0 * np.pi, 400)))
    strokes = np.where(np.gradient(volts) > 0.0, 0.15e-6 * volts, 0.15e-6 * volts + 4e-11 * volts * (1000.0 - volts))
    first, other = (
        stack_test(in_memory([RecordChannel("u", units[0]), RecordChannel("y", units[1])], 100.0, np.column_stack(columns))).hysteresis
        for units, columns in ((("V", "m"), (volts, strokes)), ((volt, metre), (volts * per_volt, strokes * per_metre)))
    )
    assert other.range == pytest.approx(first.range)
    assert other.model.before.knots == pytest.approx(first.model.before.knots)
    assert other.width == pytest.approx(first.width)


def test_noise_is_not_fitted():
    """White noise of 0.5 % of the stroke: the error is that of the noise, on kept parts of the record too; the size stays small."""
    volts = legs(INWARD)
    plant = preisach(STROKE, RANGE, 0.15)
    noise = np.random.default_rng(3).normal(0.0, 0.005 * STROKE, len(volts))
    found = identify_hysteresis(volts, plant.run(volts) + noise)
    assert 0.0045 < found.rms < 0.0065
    assert found.validation < 1.1 * found.rms
    assert found.model.thresholds.shape[1] <= 16


def refused(volts, strokes):
    with pytest.raises(DesignError) as error:
        identify_hysteresis(volts, strokes)
    return str(error.value)


def test_bad_records_are_refused_with_numbers():
    volts = legs(INWARD)
    strokes = bouc_wen(STROKE, RANGE, 0.15).run(volts)
    dip = 20e-6 * np.exp(-(((volts - 600.0) / 60.0) ** 2))
    fast = legs(INWARD, 5)
    short = "21 of 21 branches have fewer than 10 samples: branch 1 from 0 V to 1000 V has 6"
    assert "changes from 0 V to 1000 V without reversal" in refused(legs([0, 1000], 60), strokes[:61])
    assert "no rising branch after the first covers at least 80% of the range, 0 V to 1000 V" in refused(volts[:61], strokes[:61])
    assert "got 30, expected at least 40" in refused(volts[:30], strokes[:30])
    assert short in refused(fast, bouc_wen(STROKE, RANGE, 0.15).run(fast))
    assert "all samples equal 0: the channel has no signal" in refused(volts, 0.0 * strokes)
    assert "volts: all samples equal 5" in refused(0.0 * volts + 5.0, strokes)
    assert "the stroke changes by 1000 m" in refused(strokes, volts)
    assert "it leads the voltage" in refused(1e6 * strokes, 1e-7 * volts)
    assert "the stroke falls by" in refused(volts, -strokes)
    assert "m less at 575 V than at 525 V" in refused(volts, strokes - dip)
    assert "drifts by 3.1%" in refused(volts, strokes + np.linspace(0.0, 5e-6, len(volts)))
    assert "sample 7 is nan" in refused(np.where(np.arange(len(volts)) == 7, np.nan, volts), strokes)
    assert "got volts (631,), strokes (630,)" in refused(volts, strokes[1:])


def test_no_rate_independent_hysteresis_is_refused():
    """A stroke that wanders apart from the volts is fitted by no model."""
    volts = legs(INWARD)
    wander = 60e-6 * np.sin(0.026 * np.arange(len(volts)))
    assert "the hysteresis is probably rate dependent" in refused(volts, 1.5e-7 * volts + wander)


def test_warnings_say_what_a_record_does_not_show():
    volts = legs([0, 1000, 0, 1000, 0], 80)
    found = identify_hysteresis(volts, preisach(STROKE, RANGE, 0.15).run(volts), limits=(-200.0, 1100.0))
    assert "no inner loops" in found.warnings[0].what
    assert "0 V to 1000 V is only 77% of the actuator's range" in found.warnings[1].what
    assert (found.branches, found.inner) == (4, 0)


def test_the_width_is_told_relative_to_the_stroke_of_the_major_loop():
    """If only the first branch covers the whole range, the stroke is that of the others: the width belongs to the larger stroke."""
    legs = ((0, 1e3), (1e3, 170), (170, 1e3), (1e3, 200), (200, 800), (800, 170), (170, 600), (600, 170))
    volts = np.concatenate([np.linspace(*leg, 60) for leg in legs])
    found = identify_hysteresis(volts, bouc_wen(150e-6, (0.0, 1000.0), 0.15).run(volts))
    whole = major_loop(found.model, found.range)
    assert found.stroke < 0.85 * whole.stroke[0]
    assert found.width == pytest.approx(whole.width[0], rel=0.01)
    assert "the width by the major loop's stroke" in StackTest.TABLE.notes[0]


def test_small_turns_are_noise():
    volts = legs([0, 1000, 0], 50) + 20.0 * np.sin(np.arange(101))
    assert [(each.rises, each.swing > 900.0) for each in branches_of(volts)] == [(True, True), (False, True)]


def test_a_play_encloses_its_area():
    """One play of threshold r and weight p over a range R: area p 2 r (R - 2 r), width 2 r p at the middle."""
    loop = major_loop(PrandtlIshlinskii([0.0, 100.0], [0.0, 1e-7]), RANGE, count=1001)
    area = np.trapezoid((loop.down - loop.up)[:, 0], loop.volts)
    assert area == pytest.approx(1e-7 * 200.0 * 800.0, rel=1e-12)
    assert loop.width[0] * loop.stroke[0] == pytest.approx(2e-5, rel=1e-12)


def test_exponentials_follow_the_logarithm():
    for rate in (0.02, -0.01):
        coarse, fine = (exponentials(LogCreep(rate, 0.1), (0.01, 1000.0), per_decade=count) for count in (1, 2))
        assert coarse.error < 0.03 * abs(rate)
        assert fine.error < 0.001 * abs(rate)
        times = np.geomspace(0.01, 1000.0, 4321)
        for fit in (coarse, fine):
            away = np.max(np.abs(fit.creep.step_response(times)[:, 0] - LogCreep(rate, 0.1).at(times)))
            np.testing.assert_allclose(fit.error, away, rtol=0.01)
        assert np.all(np.sign(rate) * fine.creep.gains >= 0.0)


def test_creep_is_exact_between_samples():
    """Held inputs: the system that loops sample equals the closed form of the step response, and rests where it has settled."""
    from flexstage.control.systems.sampling import discretise

    creep = Creep([1.0, 0.9], [[0.1, 0.05], [0.2, 0.0]], [[2.0, 0.3], [5.0, 1.0]])
    names = (Channel("u1", "m"), Channel("u2", "m")), (Channel("y1", "m"), Channel("y2", "m"))
    found = discretise(creep.system(*names), 0.25)

    def run(inputs: np.ndarray, state: np.ndarray) -> np.ndarray:
        outputs = []
        for value in inputs:
            outputs.append(found.C @ state + found.D @ value)
            state = found.A @ state + found.B @ value
        return np.array(outputs)

    assert run(np.ones((40, 2)), np.zeros(4)) == pytest.approx(creep.step_response(0.25 * np.arange(40)), abs=1e-14)
    settled = run(np.tile([0.3, -0.7], (5, 1)), np.linalg.solve(np.eye(4) - found.A, found.B @ [0.3, -0.7]))
    assert settled == pytest.approx(np.tile(settled[:1], (5, 1)), abs=1e-14)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: LogCreep(0.02, 0.0), "per decade, reference time 0 s"),
        (lambda: exponentials(LogCreep(0.02), (1.0, 0.1)), "1 s to 0.1 s"),
        (lambda: Creep([1.0], [0.1], [0.0]), "a time constant is not positive"),
        (lambda: Creep([1.0], [0.1, 0.2], [1.0]), "shapes do not match"),
    ],
)
def test_creeps_that_are_none_are_refused(make, words):
    with pytest.raises(DesignError) as error:
        make()
    assert words in str(error.value)


def stepped(rate=0.02, noise=0.0, end=200.0):
    """A step of 500 V at 1 s that makes 100 um after 0.1 s, then creeps."""
    times = np.arange(0.0, end, 0.02)
    strokes = np.where(times < 1.0, 3e-6, 3e-6 + 1e-4 * LogCreep(rate).at(np.maximum(times - 1.0, 1e-3)))
    return times, np.where(times < 1.0, 0.0, 500.0), strokes + noise * np.random.default_rng(5).normal(size=len(times))


def test_creep_is_identified_from_a_step():
    exact = identify_creep(*stepped())
    assert exact.law.rate == pytest.approx(0.02, rel=1e-4)
    assert exact.stroke == pytest.approx(1e-4, rel=1e-4)
    noisy = identify_creep(*stepped(noise=2e-7))
    assert noisy.law.rate == pytest.approx(0.02, abs=0.0005)
    assert noisy.span == pytest.approx((0.1, 198.98), abs=0.03)


def test_bad_step_records_are_refused_with_numbers():
    times, volts, strokes = stepped()

    def refused_creep(*record):
        with pytest.raises(DesignError) as error:
            identify_creep(*record)
        return str(error.value)

    assert "got 5 V throughout" in refused_creep(times, 0.0 * volts + 5.0, strokes)
    assert "the voltage step lasts from 1.98 s to 198 s" in refused_creep(times, times, strokes)
    assert "ends too soon after the step (got 0.48 s" in refused_creep(*(each[:75] for each in (times, volts, strokes)))
    assert "rms deviation from the logarithmic law" in refused_creep(times, volts, strokes + 1e-5 * np.sin(times))
    assert "a sample is not finite" in refused_creep(times, volts, np.where(times > 3.0, np.nan, strokes))
    assert "times must ascend" in refused_creep(times[::-1], volts[::-1], strokes)
    assert "times (10000,)" in refused_creep(times, volts[1:], strokes)


def test_a_stacks_loop_is_scaled_to_others():
    """Over other volts and with another stroke: the same loop, point by point, inner ones too."""
    bend = Envelope([-100.0, 400.0, 900.0], [-120.0, 450.0, 1000.0])
    model = PrandtlIshlinskii([0.0, 80.0, 200.0], [1e-7, 3e-8, 2e-8], bend, straight([1.0], 4e-6))
    others = scale_to_stacks(model, (-100.0, 900.0), np.array([-100.0, -200.0]), np.array([900.0, 300.0]), np.array([150e-6, 60e-6]))
    shape = legs([0, 1000, 0, 700, 200, 900, 0])
    found = others.run(np.stack([shape - 100.0, 0.5 * shape - 200.0], axis=1))
    own, size = model.run(shape - 100.0), major_loop(model, (-100.0, 900.0))
    assert found[30:, 0] / 150e-6 == pytest.approx(found[30:, 1] / 60e-6, abs=1e-12)
    assert found[30:, 0] / 150e-6 == pytest.approx((own[30:] - size.up[0]) / size.stroke[0], abs=1e-12)


def test_stacks_that_are_none_are_refused():
    model = PrandtlIshlinskii([0.0], [1e-7])
    with pytest.raises(DesignError, match=r"stack 1: invalid range or stroke \(got 5 V to 5 V"):
        scale_to_stacks(model, RANGE, np.array([0.0, 5.0]), np.array([1.0, 5.0]), np.array([1e-4, 0.0]))
    with pytest.raises(DesignError, match="wrong number of axes"):
        scale_to_stacks(PrandtlIshlinskii(np.zeros((2, 1)), np.ones((2, 1))), RANGE, np.zeros(1), np.ones(1), np.ones(1))
    with pytest.raises(DesignError, match="no range"):
        scale_to_stacks(model, (1.0, 0.0), np.zeros(1), np.ones(1), np.ones(1))
