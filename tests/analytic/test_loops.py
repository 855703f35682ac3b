"""Loops whose answers are known in closed form: margins of textbook loops, an integrator with delay, the order of sampling."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import CASES
from flexstage.control.example import integral
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.plant_models.electronics import AmplifierSettings, GaugeSettings, Hardware, sampling_chain
from flexstage.control.plant_models.plants import Plant, plant, zero_order_hold
from flexstage.control.robustness.disk import DiskMargin, disk_margin, disk_margins
from flexstage.control.robustness.stability import verdict
from flexstage.control.robustness.stability_margins import bandwidths, crosstalk, margins, peaks
from flexstage.control.systems.closed import LoopBreak, loop, open_at
from flexstage.control.systems.curves import sensitivity
from flexstage.control.systems.sampling import first_order_hold
from flexstage.control.systems.system import System, select
from flexstage.models.ideal import ideal
from flexstage.models.linear.model import Channel
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.models.mapped import mapped

METRE = Channel("error.x", "m"), Channel("command.B", "m")


def _bare(A, B, C, rate=None, delay=0.0):
    """A plant of one axis given by its matrices."""
    outputs = (Channel("gap.S", "m"), Channel("relative.x", "m"))
    system = System(A, B, np.vstack([C, C]), np.zeros((2, B.shape[1])), (Channel("B", "m"),), outputs)
    axes = Coordinates(("x",), ("m",), ("B",), ("S",), np.eye(1), np.eye(1), np.eye(1), 1.0)
    states = tuple(f"amplifier.B.{number + 1}" for number in range(len(A)))
    return Plant(system, states, axes, Hardware(rate, delay), np.zeros(0), np.zeros(0), 0, "", "")


def _closed(numerator, denominator):
    """Negative feedback around a transfer function, the controller 1."""
    order = len(denominator) - 1
    A = np.diag(np.ones(order - 1), 1)
    A[-1] = -np.array(denominator[:0:-1]) / denominator[0]
    C = np.zeros((1, order))
    C[0, : len(numerator)] = np.array(numerator[::-1]) / denominator[0]
    one = System(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.eye(1), METRE[:1], METRE[1:])
    return loop(_bare(A, np.eye(order)[:, -1:], C), one)


def test_seiler_packard_gahinet():
    """L = 25/(s^3 + 10 s^2 + 10 s + 10), the running example of "An introduction to disk margins" (IEEE Control Systems 40, 2020).

    There: gains up to 3.6, phase 29.1 degrees; symmetric disk margin 0.46, gains 0.63 to 1.59, phases to 25.8 degrees.
    """
    closed = _closed([25.0], [1.0, 10.0, 10.0, 10.0])
    own = margins(closed, LoopBreak.POSE).of("x")
    assert abs(own.gain_high.value - 3.6) < 1e-9  # 90/25, at omega^2 = 10
    assert abs((2.0 * np.pi * own.gain_high.frequency) ** 2 - 10.0) < 1e-9
    assert round(np.degrees(own.phase.value), 1) == 29.1
    assert round(own.disk.value, 2) == 0.46
    found = disk_margins(closed, LoopBreak.POSE)
    assert (round(found.gain_low, 2), round(found.gain_high, 2)) == (0.63, 1.59)
    assert round(np.degrees(found.phase), 1) == 25.8


def test_a_loop_that_neither_grows_nor_decays_is_not_stable():
    """A pole at rest that no gain moves, beside one that decays."""
    found = verdict(_closed([0.0], [1.0, 1.0, 0.0]))
    assert not found.stable
    assert found.slowest_pole.growth == 0.0
    assert np.isnan(found.gain_low)


def test_gain_limits_are_found_up_to_a_factor_of_a_thousand():
    """s^3 + 2 s^2 + s + k is stable for k < 2: from a gain of 2/990, or of 990 with a zero at the limit below, the limit is in reach."""
    found = verdict(_closed([2.0 / 990.0], [1.0, 2.0, 1.0, 0.0]))
    assert found.gain_high == pytest.approx(990.0, rel=1e-9)


def test_skewed_disks():
    """With skew 1 the disk margin is 1/||S||, with -1 it is 1/||T|| (the same paper): the peaks of S and T."""
    closed = _closed([25.0], [1.0, 10.0, 10.0, 10.0])
    own, found = sensitivity(open_at(closed, LoopBreak.POSE)), peaks(closed, LoopBreak.POSE)
    assert np.isclose(disk_margin(own, 1.0).value, 1.0 / found.sensitivity.value, rtol=1e-10)
    assert np.isclose(disk_margin(own, -1.0).value, 1.0 / found.complementary.value, rtol=1e-10)


def test_gain_and_phase_of_a_disk():
    """alpha = 2/3 balanced: gains from 1/2 to 2, phase 2 atan(1/3); skew 1 and alpha = 1/2: 2/3 to 2."""
    balanced = DiskMargin(("x",), 0.0, 2.0 / 3.0, 2.0 / 3.0, 1.0, covered=True)
    assert np.allclose([balanced.gain_low, balanced.gain_high, balanced.phase], [0.5, 2.0, 2.0 * np.arctan(1.0 / 3.0)])
    skewed = DiskMargin(("x",), 1.0, 0.5, 0.5, 1.0, covered=True)
    assert np.allclose([skewed.gain_low, skewed.gain_high], [2.0 / 3.0, 2.0])


@pytest.mark.parametrize("skew", [0.0, 1.0, -1.0])
def test_two_loops_that_are_one(skew):
    """A factor on either side of one loop: (1 + a)^2/(1 - a)^2 = (1 + b)/(1 - b) with b = 2a/(1 + a^2), so that |b| <= 2|a|/(1 - |a|^2)."""
    plain = _closed([25.0], [1.0, 10.0, 10.0, 10.0])
    both, one = disk_margins(plain, None, skew), disk_margin(sensitivity(open_at(plain, LoopBreak.POSE)), skew)
    assert both.covered
    assert both.reached < one.value
    if skew == 0.0:
        half = 0.5 * one.value
        assert 2.0 * (np.sqrt(1.0 + half**2) - 1.0) / half < both.reached < 2.0 * (1.0 - np.sqrt(1.0 - half**2)) / half


def _integrator(rate, gain, delay):
    """u' = gain e on a plant of gain 1, the delay held exactly."""
    bare = _bare(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), rate, delay)
    bare = replace(bare, system=replace(bare.system, D=np.ones((2, 1))))
    return loop(bare, System(np.eye(1), np.eye(1), gain / rate * np.eye(1), np.zeros((1, 1)), METRE[:1], METRE[1:], 1.0 / rate))


def test_integrator_with_delay():
    """y[k+1] = y[k] + g T e[k]: the gain may grow to 2/T; with one sample more, x^2 - x + gT: to 1/T, at a sixth of the rate."""
    rate = 1000.0
    own = margins(_integrator(rate, 100.0, 0.0), LoopBreak.POSE).of("x")
    # Read before the output arrives: what is held is one sample old, with delay 0 as with 1 sample less a little.
    assert np.isclose(own.gain_high.value, 1.0 / (100.0 / rate))
    assert np.isclose(own.gain_high.frequency, rate / 6.0)
    later = margins(_integrator(rate, 100.0, 1.0 / rate), LoopBreak.POSE).of("x")
    assert np.isclose(later.gain_high.value, 2.0 * np.sin(np.pi / 10.0) / 0.1)  # z^2 (z - 1) + g T: at a tenth of the rate
    assert np.isclose(later.gain_high.frequency, rate / 10.0)


def test_the_gain_of_an_integrator_at_once_ends_at_half_the_rate():
    """A rectangle that the last sample ends, read a sample later: L = g T/(z - 1), real and negative at z = -1 only, so up to 2/(g T)."""
    rate, gain = 1000.0, 100.0
    one = _integrator(rate, gain, 0.0)
    own = margins(loop(one.plant, replace(one.controller, D=one.controller.C)), LoopBreak.POSE).of("x")
    assert np.isclose(own.gain_high.value, 2.0 * rate / gain, rtol=1e-9)
    assert np.isclose(own.gain_high.frequency, 0.5 * rate, rtol=1e-9)
    assert own.gain_low.value == 0.0


def test_delay_margin_of_an_integrator():
    """Continuous e^{-s tau} g/s: tau = pi/(2 g); sampled ever faster with its own sample and a half of delay: the rest of that."""
    for rate, tolerance in ((1e3, 0.05), (1e4, 0.005)):
        found = margins(_integrator(rate, 100.0, 0.0), LoopBreak.POSE).of("x").delay.value
        assert abs(found + 1.0 / rate - np.pi / 200.0) < tolerance * np.pi / 200.0


def test_delay_of_a_phase_that_leads():
    """L = g s^2/(s + 1)^3 leads by less than half a turn at both frequencies of gain 1: a delay goes the long way round to -1."""
    gain = 2.62
    own = margins(_closed([gain, 0.0, 0.0], [1.0, 3.0, 3.0, 1.0]), LoopBreak.POSE).of("x")
    omega = np.sqrt(np.max(np.roots([1.0, 3.0 - gain**2, 3.0, 1.0]).real))  # g^2 w^4 = (1 + w^2)^3
    assert 3.0 * np.arctan(omega) < np.pi
    assert np.isclose(own.delay.value, (2.0 * np.pi - 3.0 * np.arctan(omega)) / omega, rtol=1e-10)
    assert np.isclose(own.delay.frequency, omega / (2.0 * np.pi), rtol=1e-10)


def test_no_delay_is_short_enough():
    """A continuous loop whose gain stays above 1 at ever higher frequencies bears no delay at all."""
    system = System(-np.eye(1), np.eye(1), np.array([[1.0]]), np.array([[2.0]]), METRE[:1], METRE[1:])
    closed = loop(_bare(-1e3 * np.eye(1), 1e3 * np.eye(1), np.eye(1)), system)
    assert margins(closed, LoopBreak.POSE).of("x").delay.value > 0.0
    direct = _bare(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)))
    at_once = loop(replace(direct, system=replace(direct.system, D=np.ones((2, 1)))), system)
    assert margins(at_once, LoopBreak.POSE).of("x").delay.value == 0.0


def _sampled(rate, delay=0.0):
    stage = parallelogram()
    slow, seen = AmplifierSettings(bandwidth=500.0), GaugeSettings(bandwidth=2000.0)
    given = sampling_chain(stage, rate=rate, delay=delay if rate else 0.0, amplifiers=slow, gauges=seen)
    one = plant(lumped(stage), ideal(stage), given, modes=2)
    return loop(one, integral(one, 150.0))


def test_sampling_is_of_first_order():
    """A sample of delay: the continuous loop in proportion to T. That counted: an integral of held samples, exact but for aliases."""
    at = np.array([3.0, 30.0, 200.0])
    exact = open_at(_sampled(None), LoopBreak.POSE).transfer(at)[:, 0, 0]
    first, second = [], []
    for rate in (2e4, 4e4, 8e4):
        found = open_at(_sampled(rate, 1.0 / rate), LoopBreak.POSE).transfer(at)[:, 0, 0]
        first.append(np.abs(found - exact))
        second.append(np.abs(found - exact * np.exp(-2j * np.pi * at / rate)))
    for few, many in pairwise(first):
        assert np.all(np.abs(few / many - 2.0) < 0.1)
    for few, many in pairwise(second):
        assert np.all(few / many > 16.0)


def test_hold_of_the_plant_alone():
    """Held and delayed, the plant at a frequency is the continuous one times e^{-s(T/2 + delay)} to second order."""
    at = np.array([5.0, 60.0])
    errors = []
    for rate in (2e4, 4e4):
        one = _sampled(rate, 30e-6).plant
        found = select(zero_order_hold(one), ["B"], ["gap.S"]).transfer(at)[:, 0, 0]
        exact = select(one.system, ["B"], ["gap.S"]).transfer(at)[:, 0, 0] * np.exp(-2j * np.pi * at * (0.5 / rate + 30e-6))
        errors.append(np.abs(found / exact - 1.0))
    assert np.all(np.abs(errors[0] / errors[1] - 4.0) < 0.2)


def test_straight_lines_between_samples_are_met_exactly():
    """An oscillator without damping follows u = t by t - sin(w t)/w, however long the steps are."""
    omega, step = 3.0, 0.7
    A, B = np.array([[0.0, 1.0], [-(omega**2), 0.0]]), np.array([[0.0], [omega**2]])
    found = first_order_hold(System(A, B, np.array([[1.0, 0.0]]), np.zeros((1, 1)), METRE[:1], METRE[1:]), step)
    state, times, answers = np.zeros(2), step * np.arange(12), []
    for time in times:
        answers.append(found.C @ state + found.D[:, 0] * time)
        state = found.A @ state + found.B[:, 0] * time
    np.testing.assert_allclose(np.ravel(answers), times - np.sin(omega * times) / omega, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("name", ["double-triangle", "parallelogram", "xy-stage", "bridge", "hexapod", "tip-tilt", "tip-tilt-four"])
def test_every_stage_closes(name):
    """Every shipped stage whose strokes make its motions, in its own coordinates: under slow integral control, errors at rest vanish."""
    stage = CASES[name].build()
    one = plant(lumped(stage), ideal(stage), sampling_chain(stage, rate=5e3, delay=1e-4), modes=8)
    closed = loop(one, integral(one, 5.0))
    found = verdict(closed)
    assert found.stable, found.sentence
    table = crosstalk(closed)
    own = table.part(table.columns, table.columns).values
    assert np.allclose(own, np.eye(len(own)), atol=2e-2)
    estimated = select(closed.system, [f"reference.{n}" for n in one.coordinates.names], [f"pose.{n}" for n in one.coordinates.names])
    assert np.allclose(estimated.transfer(np.zeros(1))[0], np.eye(len(own)), atol=1e-7)


@pytest.mark.parametrize("theory", [lumped, mapped])
def test_plants_keep_static_gains(theory):
    """Whatever modes are kept, the stage under strokes at rest is the one of the whole model."""
    stage = double_triangle()
    model = theory(stage)
    for modes in (6, None):
        one = plant(model, ideal(stage), sampling_chain(stage, rate=10e3), modes=modes)
        outputs = [*(f"gap.{name}" for name in one.gauges), "relative.x", "platform.x"]
        found = select(one.system, one.actuators, outputs).transfer(np.zeros(1))[0]
        wanted = static_gain(model, (*one.gauges, "platform.x", "platform.x"), one.actuators).values
        assert np.allclose(found, wanted, rtol=1e-8, atol=1e-10)


def test_platform_rides_on_the_ground():
    """The ground moved slowly: the platform goes with it, and nothing moves against it."""
    stage = parallelogram()
    one = plant(lumped(stage), ideal(stage), sampling_chain(stage), modes=4, points=("corner",))
    found = select(one.system, ["ground.x", "ground.rz"], ["platform.x", "relative.x", "corner.y", "relative.corner.y", "gap.S"])
    still = found.transfer(np.zeros(1))[0].real
    assert np.allclose(still[:, 0], [1.0, 0.0, 0.0, 0.0, 0.0], atol=1e-9)
    assert np.allclose(still[[1, 3, 4], 1], 0.0, atol=1e-9)
    assert abs(still[2, 1]) > 1e-3  # the corner's arm


def test_pairs_stay_together():
    stage = double_triangle()
    assert (
        len(plant(lumped(stage), ideal(stage), sampling_chain(stage, rate=10e3), modes=7).frequencies) == 9
    )  # with a third one near to them
    assert len(plant(lumped(stage), ideal(stage), sampling_chain(stage, rate=10e3), modes=1).frequencies) == 6


def test_bandwidths_of_an_integrator():
    """g/(s + g): -3 dB at g/(2 pi), S = s/(s + g) at the same; |S| never passes 1."""
    bare = _bare(-1e5 * np.eye(1), 1e5 * np.eye(1), np.eye(1))
    closed = loop(bare, System(np.zeros((1, 1)), np.eye(1), 100.0 * np.eye(1), np.zeros((1, 1)), METRE[:1], METRE[1:]))
    found = bandwidths(closed)
    assert np.isclose(found.tracking[0], 100.0 / (2.0 * np.pi), rtol=2e-3)
    assert np.isclose(found.half_rejection[0], 100.0 / (2.0 * np.pi), rtol=2e-3)


def test_what_cannot_be_controlled_is_refused():
    """Fewer strokes than motions, gauges that see too little, names that are not there: with numbers and directions."""
    floating = CASES["xy-stage-floating"].build()
    with pytest.raises(DesignError, match=r"1 actuators produce 1 of the platform's 2 ideal motions; missing: y"):
        plant(lumped(floating), ideal(floating), sampling_chain(floating))
    stage = double_triangle()
    blind = replace(stage, gauges={"S1-S3": stage.gauges["S1-S3"]})
    with pytest.raises(DesignError, match=r"3 gauges measure 3 of the platform's 6 ideal motions; missing: "):
        plant(lumped(blind), ideal(blind), sampling_chain(blind))
    whole = plant(lumped(stage), ideal(stage), sampling_chain(stage, rate=10e3), modes=6)
    with pytest.raises(
        DesignError, match=r"different sampling \(got 0\.001 s, expected 0\.0001 s, like the hardware\)\. Use one sampling rate for both"
    ):
        loop(whole, replace(integral(whole, 1.0), step=1e-3))
    with pytest.raises(DesignError, match=r"\(got continuous, expected sampled every 0\.0001 s, like the hardware\)"):
        loop(whole, replace(integral(whole, 1.0), step=None))
    with pytest.raises(DesignError, match=r"missing output command\.B6"):
        loop(whole, select(integral(whole, 1.0), ["error.x"], [f"command.B{number}" for number in range(1, 6)]))
    with pytest.raises(DesignError, match="resistance needs the stack's capacitance, which is missing"):
        sampling_chain(_without_capacitance(stage), amplifiers=AmplifierSettings(resistance=50.0))
    with pytest.raises(DesignError, match=r"the loop has no such pose"):
        open_at(loop(whole, integral(whole, 1.0)), LoopBreak.POSE, "w")


def _without_capacitance(stage):
    parts = {name: replace(part, capacitance=None) if hasattr(part, "capacitance") else part for name, part in stage.parts.items()}
    return replace(stage, parts=parts)
