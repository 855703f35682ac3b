"""Laws of stability: verdicts against brute force and Nyquist's count; margins against the poles they bring to the edge."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from flexstage.base.finding import DesignError
from flexstage.cases.registry import case
from flexstage.control.robustness.disk import disk_margins
from flexstage.control.robustness.stability import require_stable, verdict
from flexstage.control.robustness.stability_margins import bandwidths, crosstalk, margins, peaks
from flexstage.control.study.setup import ControllerSetup, LoopSetup
from flexstage.control.study.study import loop_study
from flexstage.control.systems import norm
from flexstage.control.systems.closed import LoopBreak, loop, open_at, open_everywhere
from flexstage.control.systems.curves import sensitivity
from flexstage.control.systems.system import select
from tests.conftest import examples
from tests.laws.loops import random_loop, stable_loop

SEEDS = st.integers(0, 10_000)
LAGGED = st.booleans()


def _brute(closed, samples):
    """Rate of growth [1/s] of the loop stepped by hand: plant between the changes of its input by exponentials, a queue for the delay."""
    plant, controller = closed.plant, closed.controller
    step, delay, count = plant.hardware.step, plant.hardware.delay, len(plant.actuators)
    stage = select(plant.system, plant.actuators, [f"gap.{name}" for name in plant.gauges])
    whole = int(delay / step)
    part = delay / step - whole
    first, second = (_exact(stage, share * step) for share in (part, 1.0 - part))
    random = np.random.default_rng(0)
    state, inner = random.normal(size=len(stage.A)), random.normal(size=len(controller.A))
    queue = [np.zeros(count) for _ in range(whole + 2)]  # newest first: the output of the last sample, and those before
    size, weights = 0.0, np.ones(len(state))
    weights[len(plant.frequencies) : 2 * len(plant.frequencies)] = 1.0 / (2.0 * np.pi * plant.frequencies)  # rates as large as motions
    for number in range(samples):
        # What the gauges feel at once is the stroke that is held when they are read.
        error = -plant.coordinates.pose @ (stage.C @ state + stage.D @ queue[whole])
        command = controller.C @ inner + controller.D @ error
        inner = controller.A @ inner + controller.B @ error
        queue = [command, *queue[:-1]]
        for (moved, driven), held in ((first, queue[whole + 1]), (second, queue[whole])):
            state = moved @ state + driven @ held
        total = np.linalg.norm(np.concatenate([state * weights, inner, *queue]))
        size += np.log(total) if number >= samples // 2 else 0.0
        state, inner, queue = state / total, inner / total, [each / total for each in queue]
    return size / (samples - samples // 2) / step


def _exact(stage, time):
    size, width = stage.B.shape
    joined = np.zeros((size + width, size + width))
    joined[:size, :size], joined[:size, size:] = stage.A, stage.B
    result = expm(joined * time)
    return result[:size, :size], result[:size, size:]


@given(SEEDS, LAGGED)
@examples(4)
def test_verdict_is_what_happens(seed, lagged):
    closed = random_loop(seed, lagged=lagged)
    found = verdict(closed)
    grown = _brute(closed, 1500)
    assert abs(grown - found.slowest_pole.growth) < 3.0 + 0.05 * abs(found.slowest_pole.growth)
    if abs(found.slowest_pole.growth) > 3.0:
        assert found.stable == (grown < 0.0)


def _encirclements(system, radius):
    """How often det(I + L) goes round 0 while z goes once round a circle, refined until no step turns by more than half a radian."""
    angles = np.linspace(0.0, np.pi, 400)

    def determinants(at):
        z = radius * np.exp(1j * at)
        loops = system.C @ np.linalg.solve(
            z[:, None, None] * np.eye(len(system.A)) - system.A, np.broadcast_to(system.B, (len(z), *system.B.shape))
        )
        return np.linalg.det(np.eye(len(system.D)) + loops + system.D)

    values = determinants(angles)
    for _ in range(30):
        wild = np.flatnonzero(np.abs(np.angle(values[1:] / values[:-1])) > 0.5)
        if not len(wild):
            break
        between = 0.5 * (angles[wild] + angles[wild + 1])
        angles, values = np.insert(angles, wild + 1, between), np.insert(values, wild + 1, determinants(between))
    return 2.0 * np.sum(np.angle(values[1:] / values[:-1])) / (2.0 * np.pi)


@given(SEEDS, LAGGED)
@examples(6)
def test_verdict_is_nyquists_count(seed, lagged):
    """Poles outside the circle: those of the open loop less the turns of det(I + L); the integrators are kept inside."""
    closed = random_loop(seed, lagged=lagged)
    for cut in LoopBreak:
        open_loop, radius = open_at(closed, cut), np.exp(0.05 * closed.step)
        outside = np.sum(np.abs(open_loop.poles) > radius)
        turns = _encirclements(open_loop, radius)
        assert abs(turns - round(turns)) < 1e-6
        assert np.sum(np.abs(closed.system.poles) > radius) == outside - round(turns)
    assert verdict(closed).stable == (closed.system.growth < 0.0)


@given(SEEDS, st.sampled_from([1000.0, None]))
@examples(5)
def test_sensitivities_add_up(seed, rate):
    """S + T = I between reference and error, and S = (I + L)^-1; both cuts have the same determinant of I + L."""
    closed = random_loop(seed, rate=rate)
    names = closed.plant.coordinates.names
    at = np.array([0.7, 13.0, 190.0, 480.0])
    response = {
        kind: select(closed.system, [f"reference.{n}" for n in names], [f"{kind}.{n}" for n in names]).transfer(at)
        for kind in ("pose", "error")
    }
    identity = np.eye(len(names))
    assert np.allclose(response["pose"] + response["error"], identity, atol=1e-9 * np.max(np.abs(response["pose"])))
    loops = {cut: open_at(closed, cut).transfer(at) for cut in LoopBreak}
    assert np.allclose(response["error"] @ (identity + loops[LoopBreak.POSE]), identity, atol=1e-8)
    assert np.allclose(sensitivity(open_at(closed, LoopBreak.POSE)).transfer(at), response["error"], rtol=1e-7, atol=1e-9)
    determinants = [np.linalg.det(np.eye(each.shape[-1]) + each) for each in (*loops.values(), open_everywhere(closed).transfer(at))]
    for other in determinants[1:]:
        assert np.allclose(other, determinants[0], rtol=1e-7)


def _scaled(closed, cut, channel, factor):
    """The poles of a loop with one channel's signal multiplied."""
    alone = open_at(closed, cut, channel)
    return replace(alone, A=alone.A - alone.B * factor / (1.0 + factor * alone.D[0, 0]) @ alone.C)


@given(SEEDS, st.sampled_from([1000.0, None]), st.sampled_from(list(LoopBreak)))
@examples(3)
def test_margins_end_at_the_edge(seed, rate, cut):
    """One loop's gain multiplied by a margin has a pole on the edge at the stated frequency; between the margins it decays."""
    closed = stable_loop(seed, rate=rate)
    for each in margins(closed, cut).channels:
        for edge in (each.gain_low, each.gain_high):
            if 0.0 < edge.value < np.inf:
                moved = _scaled(closed, cut, each.channel, edge.value)
                assert abs(moved.growth) < 1e-5 * (1.0 + edge.frequency)
                points = 2j * np.pi * edge.frequency if rate is None else np.exp(2j * np.pi * edge.frequency / rate)
                assert np.min(np.abs(moved.poles - points)) < 1e-7 * max(1.0, abs(points))
        low, high = max(each.gain_low.value, 1e-3), min(each.gain_high.value, 1e3)
        for factor in np.geomspace(low * (1.0 + 1e-6), high * (1.0 - 1e-6), 7):
            assert _scaled(closed, cut, each.channel, factor).growth < 1e-6
        turned = open_at(closed, cut, each.channel).transfer(np.array([each.phase.frequency, each.delay.frequency]))[:, 0, 0]
        if np.isfinite(each.phase.value):
            assert min(abs(turned[0] * np.exp(sign * 1j * each.phase.value) + 1.0) for sign in (1.0, -1.0)) < 1e-7
            assert abs(turned[1] * np.exp(-2j * np.pi * each.delay.frequency * each.delay.value) + 1.0) < 1e-7


@given(SEEDS)
@examples(5)
def test_gain_of_all_ends_at_the_edge(seed):
    closed = random_loop(seed)
    found = verdict(closed)

    def growth(factor):
        controller = replace(closed.controller, C=factor * closed.controller.C, D=factor * closed.controller.D)
        return loop(closed.plant, controller).system.growth

    for edge in (found.gain_low, found.gain_high):
        if 0.0 < edge < np.inf:
            assert abs(growth(edge)) < 1e-6
    if found.stable:
        assert found.gain_low < 1.0 < found.gain_high
    elif np.isfinite(found.gain_high):
        assert found.gain_high <= 1.0
        assert growth(0.5 * (found.gain_low + found.gain_high)) < 0.0


@given(SEEDS, st.sampled_from([1000.0, None]))
@examples(1)
def test_disk_margins_hold(seed, rate):
    """Of all loops <= of one alone <= what gain and phase alone allow; loops within the guaranteed gains are stable, all at random."""
    closed = stable_loop(seed, rate=rate)
    random = np.random.default_rng(seed)
    for cut in LoopBreak:
        alone, together = margins(closed, cut).channels, disk_margins(closed, cut)
        assert together.covered
        assert together.guaranteed <= together.reached * (1.0 + 1e-9)
        assert together.guaranteed <= min(each.disk.value for each in alone) * (1.0 + 1e-6)
        for each in alone:
            alpha = min(each.disk.value, 2.0)
            assert (2.0 + alpha) / max(2.0 - alpha, 1e-12) <= each.gain_high.value * (1.0 + 1e-6)
            assert (2.0 - alpha) / (2.0 + alpha) >= each.gain_low.value * (1.0 - 1e-6)
            assert 2.0 * np.arctan(0.5 * alpha) <= each.phase.value * (1.0 + 1e-6)
        open_loop = open_at(closed, cut)
        low, high = max(together.gain_low, 0.0), min(together.gain_high, 1e3)
        for _ in range(10):
            factors = random.uniform(low, high, len(open_loop.D))
            inverse = np.linalg.inv(np.eye(len(factors)) + open_loop.D * factors)
            assert replace(open_loop, A=open_loop.A - (open_loop.B * factors) @ inverse @ open_loop.C).growth < 1e-9
    both = disk_margins(closed, None)
    assert both.guaranteed <= min(disk_margins(closed, cut).reached for cut in LoopBreak)


@given(SEEDS, st.sampled_from([1000.0, None]))
@examples(4)
def test_peaks_are_the_highest(seed, rate):
    """No frequency of a grid shows more than the norms of S and T, and their own shows them; a radian counts as a tenth of a metre."""
    closed = stable_loop(seed, rate=rate, coordinates=3)
    grid = np.geomspace(1e-2, 500.0 if rate else 5000.0, 1000)
    for cut, size in ((LoopBreak.POSE, np.array([1.0, 1.0, 0.1])), (LoopBreak.COMMAND, np.ones(len(closed.plant.actuators)))):
        found, system = peaks(closed, cut), sensitivity(open_at(closed, cut))

        def highest(points, turned, system=system, size=size):
            own = size[:, None] * system.transfer(points) / size
            return np.max(np.linalg.svd(np.eye(len(size)) - own if turned else own, compute_uv=False))

        for peak, turned in ((found.sensitivity, False), (found.complementary, True)):
            assert highest(grid, turned) <= peak.value * (1.0 + 1e-10)
            if np.isfinite(peak.frequency):
                assert abs(highest(np.array([peak.frequency]), turned) / peak.value - 1.0) < 1e-9


def test_a_peak_is_no_less_than_margins_make_it_whatever_the_units_of_states():
    """max|S| >= g / (g - 1), 1 / (2 sin(phi / 2)), of a loop whose S is larger at half the rate than at any of its poles."""
    found = loop_study(case("parallelogram"), LoopSetup(controller=ControllerSetup(kind="lqg")))
    (edges,) = found.margins.channels
    whole = sensitivity(open_at(found.closed, LoopBreak.POSE))
    for seed in range(8):
        units = 10.0 ** np.random.default_rng(seed).uniform(-3.0, 3.0, len(whole.A))
        scaled = replace(whole, A=whole.A * units[:, None] / units, B=whole.B * units[:, None], C=whole.C / units)
        assert norm.peak(scaled).value == pytest.approx(found.peaks.sensitivity.value, rel=1e-6)
    assert found.peaks.sensitivity.value >= max(1.0 / (1.0 - 1.0 / edges.gain_high.value), 0.5 / np.sin(0.5 * edges.phase.value))


def test_unstable_loops_have_no_margins():
    closed = next(found for seed in range(50) if (found := random_loop(seed)).system.growth > 1.0)
    for ask in (
        bandwidths,
        crosstalk,
        lambda one: margins(one, LoopBreak.POSE),
        lambda one: disk_margins(one, LoopBreak.POSE),
    ):
        with pytest.raises(DesignError, match=r"unstable loop: a pole at .* Hz.* grows at .* 1/s, mainly due to "):
            ask(closed)
    with pytest.raises(DesignError, match="no rms values for an unstable loop"):
        require_stable(closed, "rms values")
