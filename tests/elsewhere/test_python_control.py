"""Loops against python-control, an independent control library: responses, poles, margins, disk margins, variances.

The numbers are made at test time by the pinned version; margins there come from roots of polynomials, ours from frequencies.
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy

from flexstage.base.finding import DesignError
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.control.controllers.loops import platform_loops
from flexstage.control.example import integral, integral_loop
from flexstage.control.plant_models.electronics import AmplifierSettings, GaugeSettings, sampling_chain
from flexstage.control.plant_models.plants import plant, zero_order_hold
from flexstage.control.robustness.disk import disk_margin
from flexstage.control.robustness.stability_margins import margins, peaks
from flexstage.control.study.choices import SEARCHED, ControllerKind, Criterion
from flexstage.control.study.control import make_controller
from flexstage.control.study.resolve import resolve
from flexstage.control.study.setup import ControllerSetup, Floor, GoalSetup, LoopSetup, VibrationSetup
from flexstage.control.systems.closed import Loop, LoopBreak, loop, open_at
from flexstage.control.systems.curves import sensitivity
from flexstage.control.systems.exchange import from_control, to_control
from flexstage.control.systems.norm import peak
from flexstage.control.systems.system import System, select
from flexstage.control.tuning.find import find
from flexstage.control.tuning.laws import PI_FAMILY
from flexstage.control.tuning.objective import TuningObjective
from flexstage.control.tuning.spec import TuningSpec
from flexstage.control.white_noise import mean_squares
from flexstage.models.ideal import ideal
from flexstage.models.linear.model import Channel
from flexstage.models.lumped import lumped

CLOSE, ZERO = 1e-9, 1e-12


def _loop(rate: float | None, gain: float, name: str = "parallelogram", modes: int = 2) -> Loop:
    stage = case(name)
    delay = 60e-6 if rate else 0.0
    given = sampling_chain(
        stage, rate=rate, delay=delay, amplifiers=AmplifierSettings(bandwidth=900.0), gauges=GaugeSettings(bandwidth=np.inf)
    )
    one = plant(lumped(stage), ideal(stage), given, modes=modes)
    return loop(one, integral(one, gain))


def _like(system: System, response):
    """The largest of all entries of the same kind, rotations and moments taken at 50 mm: what is 0 by symmetry is rounding of that."""
    sizes = [
        np.array([{"m": 1.0, "rad": 0.05, "N": 1.0, "N m": 20.0}[each.unit] for each in group]) for group in (system.outputs, system.inputs)
    ]
    forces = np.array([each.unit.startswith("N") for each in system.inputs])
    scale = np.outer(sizes[0], 1.0 / sizes[1])
    largest = np.max(np.abs(response), axis=0) * scale
    return np.where(forces, np.max(largest[:, forces], initial=0.0), np.max(largest[:, ~forces])) / scale


@pytest.mark.parametrize("rate", [8e3, None])
def test_responses(rate):
    closed = _loop(rate, 100.0, "tip-tilt", 6)
    for ours in (closed.system, open_at(closed, LoopBreak.POSE), closed.plant.system):
        theirs, at = to_control(ours), np.geomspace(0.5, 3500.0, 200)
        found = np.moveaxis(np.asarray(theirs.frequency_response(2.0 * np.pi * at).frdata), -1, 0)
        mine = ours.transfer(at)
        assert np.all(np.abs(found - mine) <= CLOSE * np.abs(mine) + ZERO * _like(ours, mine))
        poles, own = np.sort_complex(theirs.poles()), np.sort_complex(ours.poles)
        assert np.allclose(poles, own, rtol=1e-6, atol=1e-9 * np.max(np.abs(own)))


@pytest.mark.parametrize("rate", [8e3, None])
@pytest.mark.parametrize("gain", [50.0, 200.0, 400.0])
def test_closed_by_feedback(rate, gain):
    """The closed loop of python-control's `feedback` around our open loop is ours."""
    import control

    closed = _loop(rate, gain, "tip-tilt", 6)
    open_loop = to_control(open_at(closed, LoopBreak.POSE))
    at = np.geomspace(0.5, 3500.0, 100)
    found = control.feedback(open_loop, control.ss([], [], [], np.eye(3), open_loop.dt))
    theirs = np.moveaxis(np.asarray(found.frequency_response(2.0 * np.pi * at).frdata), -1, 0)
    mine = np.eye(3) - sensitivity(open_at(closed, LoopBreak.POSE)).transfer(at)
    assert np.max(np.abs(theirs - mine)) < CLOSE * np.max(np.abs(mine))


@pytest.mark.parametrize("gain", [50.0, 200.0, 400.0])
def test_margins(gain):
    """A continuous loop: every margin by the roots of polynomials."""
    import control

    closed = _loop(None, gain)
    own = margins(closed, LoopBreak.POSE).of("x")
    gains, phases, _, at_gain, at_phase, _ = control.stability_margins(
        to_control(open_at(closed, LoopBreak.POSE)), returnall=True, method="poly"
    )
    place, least = int(np.argmin(np.where(np.asarray(gains) > 1.0, gains, np.inf))), int(np.argmin(np.abs(phases)))
    assert abs(gains[place] / own.gain_high.value - 1.0) < CLOSE
    assert abs(at_gain[place] / (2.0 * np.pi) / own.gain_high.frequency - 1.0) < CLOSE
    assert abs(np.radians(abs(phases[least])) - own.phase.value) < CLOSE
    assert abs(at_phase[least] / (2.0 * np.pi) / own.phase.frequency - 1.0) < CLOSE
    assert abs(np.min(np.radians(np.mod(phases, 360.0)) / at_phase) / own.delay.value - 1.0) < CLOSE


@pytest.mark.parametrize("gain", [50.0, 200.0, 400.0])
def test_margins_of_samples(gain):
    """A sampled loop: theirs by interpolation (their polynomials in z lose four digits), and their response at our frequencies."""
    import control

    closed = _loop(8e3, gain)
    own, loops = margins(closed, LoopBreak.POSE).of("x"), to_control(open_at(closed, LoopBreak.POSE))
    gain_high, phase, _, at_gain, at_phase, _ = control.stability_margins(loops, method="frd")
    assert abs(gain_high / own.gain_high.value - 1.0) < 1e-7
    assert abs(np.radians(phase) - own.phase.value) < 1e-7
    assert np.allclose([at_gain / (2.0 * np.pi), at_phase / (2.0 * np.pi)], [own.gain_high.frequency, own.phase.frequency], rtol=1e-6)
    edges = [own.gain_high.frequency, own.phase.frequency, own.delay.frequency]
    found = loops(np.exp(2j * np.pi * np.array(edges) * closed.step))
    factors = [own.gain_high.value, np.exp(-1j * own.phase.value), np.exp(-2j * np.pi * own.delay.frequency * own.delay.value)]
    assert np.allclose(found * factors, -1.0, atol=CLOSE)


def _found_by_search(plant_of_samples, spec: TuningSpec) -> Loop:
    tuned = find(plant_of_samples, platform_loops(plant_of_samples.coordinates), spec)
    return loop(plant_of_samples, tuned.controller.system(plant_of_samples.hardware.step))


@pytest.mark.parametrize(
    "spec",
    [
        TuningSpec(PI_FAMILY, objective=TuningObjective.BALANCE),
        pytest.param(TuningSpec(PI_FAMILY, objective=TuningObjective.REJECTION, gain=0.1), marks=pytest.mark.full),
    ],
)
def test_margins_of_what_a_search_finds(spec):
    """Gain, phase, delay and peak of S from their own responses on a dense grid, within 1e-3; and their poles at the edge of gain."""
    import control

    wired = _found_by_search(integral_loop().plant, spec)
    own, step = margins(wired, LoopBreak.POSE).of("x"), wired.step
    loops = to_control(open_at(wired, LoopBreak.POSE))
    omega = np.geomspace(1.0, 0.9999 * np.pi / step, 3_000)
    theirs = control.FRD(loops(np.exp(1j * omega * step)), omega, smooth=True)
    gain, phase, least, _, crossing, _ = control.stability_margins(theirs)
    assert gain == pytest.approx(own.gain_high.value, rel=1e-3)
    assert np.radians(phase) == pytest.approx(own.phase.value, rel=1e-3)
    assert np.radians(phase) / crossing == pytest.approx(own.delay.value, rel=1e-3)
    assert 1.0 / least == pytest.approx(peaks(wired, LoopBreak.POSE).sensitivity.value, rel=1e-3)
    inside, beyond = (np.max(np.abs(control.feedback(factor * own.gain_high.value * loops, 1).poles())) for factor in (0.999, 1.001))
    assert inside < 1.0 < beyond


def _stage_by_search(name: str, kind: ControllerKind) -> Loop:
    """The loop of a shipped stage on a VC-D floor, found by search or, of kinds without one, tuned."""
    floor = VibrationSetup(criterion=Criterion.VC_D)
    goal = GoalSetup() if kind in SEARCHED else None
    asked = LoopSetup(floor=Floor(floor, floor, floor), controller=ControllerSetup(kind=kind, goal=goal))
    given = resolve(case(name), asked)
    return loop(given.plant, make_controller(given, given.plant.coordinates.strokes).system)


@pytest.mark.full
@pytest.mark.parametrize("kind", [ControllerKind.PI, ControllerKind.PID, ControllerKind.RESONANT, ControllerKind.LQG])
@pytest.mark.parametrize("name", ["double-triangle", "tip-tilt", "scanner", "xy-stage", "steering-mirror"])
def test_margins_of_stages_by_search(name, kind):
    """One loop at a time, the others closed: 1/S_ii - 1 from python-control's response of all loops, margins read off it, within 1e-3.

    Its own `stability_margins` ends in a bracket without a change of sign on the steering mirror.
    """
    wired = _stage_by_search(name, kind)
    found, opened = margins(wired, LoopBreak.POSE), to_control(open_at(wired, LoopBreak.POSE))
    edges = [edge.frequency for each in found.channels for edge in (each.gain_high, each.gain_low, each.phase, each.delay)]
    lines = np.geomspace(0.1, 0.4999 / wired.step, 12_000)
    every = np.unique(np.concatenate([lines, *(edge * np.linspace(0.999, 1.001, 41) for edge in edges if np.isfinite(edge))]))
    omega = np.append(2.0 * np.pi * every[every < 0.5 / wired.step], np.pi / wired.step)  # at half the rate L is real
    response = np.moveaxis(opened(np.exp(1j * omega * wired.step), squeeze=False), -1, 0)
    left = np.linalg.inv(np.eye(len(found.channels)) + response)
    for number, own in enumerate(found.channels):
        gain, phase, delay = _read_off(omega, 1.0 / left[:, number, number] - 1.0)
        if np.isfinite(own.gain_high.value):
            assert gain == pytest.approx(own.gain_high.value, rel=1e-3)
        assert phase == pytest.approx(own.phase.value, rel=1e-3)
        assert delay == pytest.approx(own.delay.value, rel=1e-3)


def _read_off(omega, opened):
    """The least gain above 1, phase and delay that bring a response to -1, straight between its lines."""
    sizes, turned = np.log(np.abs(opened)), np.unwrap(np.angle(opened))
    places = np.flatnonzero(sizes[1:] * sizes[:-1] <= 0.0)
    share = sizes[places] / (sizes[places] - sizes[places + 1])
    angles = np.mod(turned[places] + share * np.diff(turned)[places] + np.pi, 2.0 * np.pi)
    at = omega[places] + share * np.diff(omega)[places]
    odd = np.floor((turned / np.pi + 1.0) / 2.0)  # steps where the phase passes an odd number of pi
    crossed = np.flatnonzero(np.diff(odd) != 0.0)
    last = [1.0 / abs(opened[-1])] if np.real(opened[-1]) < 0.0 else []
    target = np.pi * (2.0 * np.maximum(odd[crossed], odd[crossed + 1]) - 1.0)
    part = (target - turned[crossed]) / np.diff(turned)[crossed]
    factors = np.exp(-(sizes[crossed] + part * np.diff(sizes)[crossed]))
    factors = np.append(factors, last)
    return (
        np.min(factors[factors > 1.0], initial=np.inf),
        np.min(np.minimum(angles, 2.0 * np.pi - angles), initial=np.inf),
        np.min(angles / at, initial=np.inf),
    )


@pytest.mark.parametrize("rate", [8e3, None])
def test_disk_margins(rate):
    """Theirs from frequencies given, ours from the norm: with the norm's own frequency among them."""
    import control

    closed = _loop(rate, 200.0)
    for skew in (-0.5, 0.0, 1.0):
        own = disk_margin(sensitivity(open_at(closed, LoopBreak.POSE)), skew)
        at = 2.0 * np.pi * np.unique(np.append(np.geomspace(1.0, 3900.0, 300), own.frequency))
        alpha, _, _ = control.disk_margins(to_control(open_at(closed, LoopBreak.POSE)), at, skew)
        assert abs(alpha / own.value - 1.0) < CLOSE


@pytest.mark.parametrize("rate", [8e3, None])
def test_norms(rate):
    """The H-2 norm is the rms under white noise, the highest response the H-infinity norm.

    Theirs by the Gramian: `control.norm` looks for a negative eigenvalue in it, and finds one of rounding or none as the machine rounds.
    """
    import control

    closed = _loop(rate, 200.0)
    system = select(closed.system, ["noise.B"], ["relative.x"])
    if rate is None:
        theirs = to_control(system)
        square = theirs.C @ control.lyap(theirs.A, theirs.B @ theirs.B.T) @ theirs.C.T
        assert abs(square[0, 0] / mean_squares(system)[0, 0] - 1.0) < 1e-8
    found = peak(system)
    grid = 2.0 * np.pi * np.append(np.geomspace(1.0, 3900.0, 400), found.frequency)
    highest = np.max(np.abs(to_control(system).frequency_response(grid).frdata))
    assert abs(highest / found.value - 1.0) < CLOSE


def test_hold():
    """Exact sampling without delay is `sample_system`; a whole sample of delay is a shift."""
    import control

    stage = parallelogram()
    plants = [
        plant(
            lumped(stage),
            ideal(stage),
            sampling_chain(stage, rate=8e3, delay=delay, amplifiers=AmplifierSettings(bandwidth=900.0)),
            modes=2,
        )
        for delay in (0.0, 1.0 / 8e3)
    ]
    ours = [select(zero_order_hold(each), ["B"], ["gap.S"]) for each in plants]
    theirs = control.sample_system(to_control(select(plants[0].system, ["B"], ["gap.S"])), 1.0 / 8e3, method="zoh")
    at = np.geomspace(1.0, 3900.0, 100)
    response = theirs.frequency_response(2.0 * np.pi * at).frdata[0, 0]
    assert np.allclose(ours[0].transfer(at)[:, 0, 0], response, rtol=1e-8)
    assert np.allclose(ours[1].transfer(at)[:, 0, 0], response * np.exp(-2j * np.pi * at / 8e3), rtol=1e-8)


def test_stepped_by_scipy():
    """The closed loop's step, as scipy.signal and python-control march it."""
    import control

    closed = _loop(8e3, 200.0)
    system = select(closed.system, ["reference.x"], ["relative.x", "command.B"])
    reference = np.ones(400)
    _, found, _ = scipy.signal.dlsim(scipy.signal.dlti(system.A, system.B, system.C, system.D, dt=system.step), reference)
    theirs = control.forced_response(to_control(system), inputs=reference, squeeze=False)
    assert np.allclose(theirs.outputs.T, found, rtol=1e-10, atol=1e-12)
    assert abs(found[-1, 0] - 1.0) < 1e-3


def test_controllers_come_back():
    """A controller designed there closes the loop here."""
    import control

    closed = _loop(8e3, 200.0)
    theirs = control.c2d(control.tf([200.0], [1.0, 0.0]), closed.step, method="tustin")
    gain = float(closed.plant.coordinates.strokes[0, 0])
    designed = from_control(gain * theirs, closed.controller.inputs, closed.controller.outputs)
    found = loop(closed.plant, designed)
    assert found.system.growth < 0.0
    assert from_control(to_control(found.system)).input_names[0] == "reference_x"


def test_what_cannot_be_taken_is_refused():
    import control

    one = to_control(_loop(8e3, 200.0).controller)
    channel = Channel("error.x", "m")
    with pytest.raises(DesignError, match="got 2, expected 1"):
        from_control(one, (channel, channel), None)
    with pytest.raises(DesignError, match="expected a number"):
        from_control(control.ss([0.5], [1.0], [1.0], [0.0], True))
    with pytest.raises(DesignError, match="expected StateSpace"):
        from_control(3.0)
    with pytest.raises(DesignError, match="2 inputs and 1 outputs"):
        from_control(control.tf([[[1.0], [1.0]]], [[[1.0, 1.0], [1.0, 2.0]]]))
    twins = System(
        np.zeros((0, 0)), np.zeros((0, 2)), np.zeros((1, 0)), np.ones((1, 2)), (Channel("a.b", "m"), Channel("a_b", "m")), (channel,)
    )
    with pytest.raises(DesignError, match="2 names become equal"):
        to_control(twins)
