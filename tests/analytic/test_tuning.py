"""Tuning against closed forms and searches made here: what an oscillator lets integral control reach, and what is said beyond."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.dynamics.modes import modes
from flexstage.base.finding import DesignError
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.control.controllers.family import Place
from flexstage.control.controllers.loops import actuator_loops, loop_modes, modal_loops, platform_loops
from flexstage.control.controllers.lqg import Disturbances
from flexstage.control.controllers.notch import Notch
from flexstage.control.controllers.pi import PI
from flexstage.control.plant_models.electronics import Hardware
from flexstage.control.plant_models.plants import plant
from flexstage.control.robustness.stability import verdict
from flexstage.control.robustness.stability_margins import peaks
from flexstage.control.systems.closed import LoopBreak, loop, open_at
from flexstage.control.tuning.attempt import BandwidthTrial
from flexstage.control.tuning.laws import FAMILIES, LQG_FAMILY, PI_FAMILY, PID_FAMILY, RESONANT_FAMILY
from flexstage.control.tuning.spec import TuningSpec
from flexstage.control.tuning.tune import tune
from flexstage.control.tuning.view import resonances, view
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.models.mapped import mapped


@pytest.fixture(scope="module")
def oscillator():
    """The one-axis stage by the mapped model: a single mode of 1 %, static gain 1, continuous."""
    stage = parallelogram()
    return plant(mapped(stage), ideal(stage), Hardware())


@pytest.fixture(scope="module")
def sampled():
    """The same stage with three lumped modes, at 20 kHz and a sample of delay."""
    stage = parallelogram()
    return plant(lumped(stage), ideal(stage), Hardware(rate=20e3, delay=50e-6), modes=3)


def _peak(rate: float, omega: float, ratio: float = 0.01) -> float:
    """Peak of S of k/s around an oscillator, by a fine grid of its own; infinite where unstable (k >= 2 zeta omega)."""
    if rate >= 2.0 * ratio * omega:
        return np.inf
    s = 1j * omega * np.concatenate([np.geomspace(1e-3, 10.0, 4000), 1.0 + ratio * np.linspace(-5.0, 5.0, 8001)])
    return float(np.max(np.abs(1.0 / (1.0 + rate / s * omega**2 / (s**2 + 2.0 * ratio * omega * s + omega**2)))))


@pytest.mark.parametrize("allowed", [1.5, 2.0, 4.0])
def test_integral_control_reaches_what_an_oscillator_lets_it(oscillator, allowed):
    """The highest bandwidth is that whose peak of S is the one allowed, found here by halving: near 2 zeta f (1 - 1/M)."""
    found = tune(oscillator, platform_loops(oscillator.coordinates), TuningSpec(PI_FAMILY, None, allowed, 0.0, automatic=False))
    omega = 2.0 * np.pi * oscillator.frequencies[0]
    low, high = 0.0, 0.02 * omega
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _peak(middle, omega) <= allowed else (low, middle)
    assert found.bandwidth == pytest.approx(low / (2.0 * np.pi), rel=0.02)
    assert found.bandwidth == pytest.approx(0.02 * oscillator.frequencies[0] * (1.0 - 1.0 / allowed), rel=0.05)
    law = found.controller.laws[0]
    assert isinstance(law, PI)
    assert law.proportional == 0.0


def test_notches_and_modes_that_are_off(oscillator):
    """A notch on the mode gives many times the bandwidth; the more the mode may be off, the less."""
    loops = platform_loops(oscillator.coordinates)
    bare = tune(oscillator, loops, TuningSpec(PI_FAMILY, spread=0.0, automatic=False)).bandwidth
    notched = [tune(oscillator, loops, TuningSpec(PI_FAMILY, spread=spread)) for spread in (0.0, 0.02, 0.05)]
    reached = [each.bandwidth for each in notched]
    assert reached[0] > 20.0 * bare
    assert reached[0] > 1.2 * reached[1] > 1.2 * reached[2] > 3.0 * bare
    assert all(abs(each.frequency / oscillator.frequencies[0] - 1.0) < 1e-6 for found in notched for each in found.controller.notches[0])


@pytest.mark.parametrize("kind", list(FAMILIES))
def test_what_is_asked_for_is_reached(sampled, kind):
    """Every kind: the loop's own gain is 1 where asked, the verdict is stable, the peak of S that of the margins."""
    asked = {"pi": 150.0, "pid": 200.0, "resonant": 30.0, "lqg": 200.0}[kind]
    noise = Disturbances(1e-9, dict.fromkeys(sampled.gauges, 1e-11))
    found = tune(sampled, platform_loops(sampled.coordinates), TuningSpec(FAMILIES[kind], asked, 2.0, 0.0, expected=noise))
    closed = loop(sampled, found.controller.system(sampled.hardware.step))
    assert verdict(closed).stable
    assert abs(open_at(closed, LoopBreak.POSE).transfer(np.array([asked]))[0, 0, 0]) == pytest.approx(1.0, rel=0.01)
    assert found.bandwidth == pytest.approx(asked, rel=0.01)
    peak = peaks(closed, LoopBreak.POSE).sensitivity
    assert peak.value <= 2.0 * 1.01
    assert found.judgement.peak == pytest.approx(peak.value, rel=0.02)
    assert found.judgement.growth == pytest.approx(closed.system.growth, rel=1e-6)


def test_the_reason_has_the_numbers(sampled):
    """Asked too much: the peak and the highest that is reached are those of the margins, the notch's frequency that of the mode."""
    loops = platform_loops(sampled.coordinates)
    with pytest.raises(DesignError) as error:
        tune(sampled, loops, TuningSpec(PI_FAMILY, 30.0, 2.0, 0.0, automatic=False))
    said = str(error.value)
    form = r"at 30 Hz, the peak of S with PI is ([\d.]+) dB at (\d+) Hz, ([\d.]+) dB above .* allowed; the highest .* is ([\d.]+) Hz"
    level, place, above, highest = map(float, re.search(form, said).groups())
    tried = BandwidthTrial(view(sampled, loops, 0.0), TuningSpec(PI_FAMILY, 30.0, spread=0.0, automatic=False), 30.0).best()
    peak = peaks(loop(sampled, tried.controller.system(sampled.hardware.step)), LoopBreak.POSE).sensitivity
    assert level == pytest.approx(20.0 * np.log10(peak.value), abs=0.06)
    assert above == pytest.approx(20.0 * np.log10(peak.value / 2.0), abs=0.1)
    assert place == pytest.approx(peak.frequency, rel=0.01)
    for factor, good in ((1.0, True), (1.05, False)):
        law = PI(0.0, factor * _rate(tried, highest))
        control = replace(tried.controller, laws=(law,)).system(sampled.hardware.step)
        assert (peaks(loop(sampled, control), LoopBreak.POSE).sensitivity.value <= 2.0 * 1.01) is good
    notch, better = map(float, re.search(r"[Aa]dd a notch at ([\d.]+) Hz to reach a bandwidth of ([\d.]+) Hz", said).groups())
    assert notch == pytest.approx(sampled.frequencies[1], abs=0.06)
    assert tune(sampled, loops, TuningSpec(PI_FAMILY, 0.97 * better, 2.0, 0.0)).bandwidth == pytest.approx(0.97 * better, rel=0.01)


def _rate(tried, highest: float) -> float:
    return tried.controller.laws[0].integral * highest / 30.0


def test_an_unstable_attempt_is_called_so(sampled):
    """Beyond the edge of stability the growth is said; where hold and delay take part, faster samples are advised."""
    with pytest.raises(
        DesignError, match=r"with PI is unstable \(growth rate .* 1/s.*; the highest bandwidth found is .* with PI"
    ) as error:
        tune(sampled, platform_loops(sampled.coordinates), TuningSpec(PI_FAMILY, 900.0, spread=0.0, automatic=False))
    assert "hold and delay cause 24 deg of phase lag at 900 Hz" in str(error.value)  # 360 x 900 Hz x (50 + 25) us


@pytest.mark.parametrize("name", ["xy-stage", "tip-tilt", pytest.param("tip-tilt-four", marks=pytest.mark.full), "bridge"])
def test_stages_of_fewer_freedoms(name):
    """One to three axes, redundant actuators too: tuned in all coordinates that they have, and reached."""
    stage = case(name)
    model, kinematics = lumped(stage), ideal(stage)
    count = len(kinematics.coordinates)
    first = float(modes(model).frequencies[0])
    one = plant(model, kinematics, Hardware(rate=20.0 * first, delay=0.05 / first), modes=2 * count)
    found = modes(model)
    shapes = found.platform_shapes[:, list(loop_modes(found, one.coordinates))]
    kinds = [platform_loops(one.coordinates), modal_loops(one.coordinates, shapes)]
    if len(one.actuators) == count:
        kinds.append(actuator_loops(one.coordinates))
    for loops in kinds:
        tuning = tune(one, loops, TuningSpec(PI_FAMILY, 0.1 * first))
        assert tuning.bandwidth == pytest.approx(0.1 * first, rel=0.01)
        assert verdict(loop(one, tuning.controller.system(one.hardware.step))).stable


@pytest.mark.parametrize("step", [None, 1e-3])
@pytest.mark.parametrize("kind", [PI_FAMILY, PID_FAMILY, RESONANT_FAMILY])
def test_laws_have_the_gain_that_is_left(kind, step):
    """|C g| = 1 at the frequency, sampled too, where Tustin's rule bends frequencies by a tenth and more."""
    found = kind.laws(Place(180.0, 0.3 - 0.4j, 0.9, 60.0), step)
    assert len(found) > 4
    for law in found:
        response = law.system(step).transfer(np.array([180.0]))[0, 0]
        assert abs((response[0] - response[1]) * (0.3 - 0.4j)) == pytest.approx(1.0, rel=1e-9)


def test_modes_off_are_the_plant_in_faster_time(sampled):
    """Poles of the offset plants, as rates, are those of the model times 1 + offset."""
    seen = view(sampled, platform_loops(sampled.coordinates), 0.05)
    own = [np.sort(np.abs(np.log(_fast(system.poles)) / sampled.hardware.step)) for system in seen.systems]
    for offset, rates in zip(seen.offsets, own, strict=True):
        np.testing.assert_allclose(rates, own[0] * (1.0 + offset), rtol=1e-6)


def _fast(poles: np.ndarray) -> np.ndarray:
    """Without the registers of the hold."""
    return poles[np.abs(poles) > 1e-3].astype(complex)


def test_resonances_are_the_modes_that_show(oscillator, sampled):
    """The lone mode with its gain 1/(2 zeta) = 50; of three lumped modes those that move along the axis."""
    found = resonances(view(oscillator, platform_loops(oscillator.coordinates), 0.0), 0)
    assert [round(each.gain, 2) for each in found] == [50.0]
    shown = resonances(view(sampled, platform_loops(sampled.coordinates), 0.0), 0)
    assert [each.frequency for each in shown] == [pytest.approx(sampled.frequencies[1])]


BAD = {
    "bandwidth: 12000 Hz is not below half the sampling rate, 10000 Hz": TuningSpec(PI_FAMILY, 12e3),
    "bandwidth: must be positive (got -5 Hz)": TuningSpec(PI_FAMILY, -5.0),
    "must be above 1 (got 0.9)": TuningSpec(PI_FAMILY, 5.0, 0.9),
    "must be at least 0 and below 0.5 (got -0.1)": TuningSpec(PI_FAMILY, 5.0, 2.0, -0.1),
    "notch at 1200 Hz: no mode within 10 % (nearest: 875": TuningSpec(PI_FAMILY, 5.0, notches=(Notch(1200.0),)),
    "notches: LQG models the modes in its observer, without notches (got 1)": TuningSpec(LQG_FAMILY, 5.0, notches=(Notch(875.0),)),
    "the observer's noise is missing": TuningSpec(LQG_FAMILY, 5.0),
}


@pytest.mark.parametrize("said", BAD)
def test_bad_tasks_are_named_with_their_numbers(sampled, said):
    """What cannot be is refused before anything is tried."""
    with pytest.raises(DesignError) as error:
        tune(sampled, platform_loops(sampled.coordinates), BAD[said])
    assert said in str(error.value)


@pytest.fixture(scope="module")
def shipped():
    """The shipped stage with twelve modes, six axes at 10 kHz and a sample of delay; and its modes."""
    stage = case("double-triangle")
    model = lumped(stage)
    return plant(model, ideal(stage), Hardware(rate=10e3, delay=1e-4), modes=12), modes(model)


def test_the_shipped_stage_in_all_coordinates(shipped):
    """PI with notches at 25 Hz, modes up to 2 % off, in platform and modal coordinates."""
    one, found = shipped
    for loops in (platform_loops(one.coordinates), modal_loops(one.coordinates, found.platform_shapes[:, list(found.platform)])):
        seen = view(one, loops, 0.02)
        tried = BandwidthTrial(seen, TuningSpec(PI_FAMILY), 25.0).best()
        assert tried.reaches()
        placed = {round(notch.frequency, 1) for group in tried.notches for notch in group}
        assert placed <= {round(float(each), 1) for each in found.platform_frequencies}
        closed = loop(one, tried.controller.system(1e-4))
        assert verdict(closed).stable
        assert peaks(closed, LoopBreak.POSE).sensitivity.value <= 2.0


def test_no_motion_creeps_to_its_place(shipped):
    """Of a slow disturbance integrators that pass 1 at 25 Hz leave f/25 Hz in every axis; the laws of lowest peak leave five times that."""
    one, _ = shipped
    loops, spec = platform_loops(one.coordinates), TuningSpec(PI_FAMILY, 25.0)
    calmest, found = BandwidthTrial(view(one, loops, spec.spread), spec, 25.0).best(), tune(one, loops, spec)
    left = []
    for each in (calmest, found):
        gains = open_at(loop(one, each.controller.system(1e-4)), LoopBreak.POSE).transfer(np.array([0.25]))[0]
        left.append(np.max(np.abs(np.diag(np.linalg.inv(np.eye(6) + loops.sense @ gains @ np.linalg.inv(loops.sense))))))
    assert found.judgement.peak <= 2.0
    assert left[1] < 0.25 / 25.0 < left[0] / 5.0


def test_a_search_tries_no_law_twice_at_a_frequency(sampled, monkeypatch) -> None:
    """One width for all modes comes after the loops' own choices, stronger integrators after the lowest peak: with the same laws."""
    tried = []
    counted = replace(PI_FAMILY, laws=lambda *asked: tried.append(asked) or PI_FAMILY.laws(*asked))
    for module in ("attempt", "tune"):
        monkeypatch.setattr(f"flexstage.control.tuning.{module}.PI_FAMILY", counted)
    found = tune(sampled, platform_loops(sampled.coordinates), TuningSpec(counted))
    assert len(found.controller.notches[0]) > 0
    assert len(tried) == len(set(tried))
