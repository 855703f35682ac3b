"""Modes that a loop's plant retains: margins, bandwidths and gains against plants with all modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.base.units.scale import X, Y, Z, mm
from flexstage.cases.registry import CASES, case
from flexstage.control.plant_models.plants import zero_order_hold
from flexstage.control.plant_models.reduction import mode_names, reduce_modes
from flexstage.control.plant_models.retention import retention
from flexstage.control.robustness.stability_margins import margins, peaks
from flexstage.control.study.choices import ControllerKind
from flexstage.control.study.control import make_controller
from flexstage.control.study.resolve import resolve, retain_modes
from flexstage.control.study.retained import control_and_modes
from flexstage.control.study.setup import AmplifierSetup, ControllerSetup, GaugeSetup, LoopSetup
from flexstage.control.study.study import loop_study
from flexstage.control.systems.closed import LoopBreak, loop, pose_controller
from flexstage.control.systems.curves import curves
from flexstage.control.systems.system import select
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, ModalDamping, Probe
from flexstage.parts.body import Body, Inertia
from flexstage.parts.encoder import Encoder
from flexstage.parts.freedom import Freedom
from flexstage.parts.spring import Spring
from flexstage.parts.voice_coil import VoiceCoil

_OPEN = ("xy-stage-floating", "mirror-mount", "telescope-mount", "leaf-guide", "resonator", "quad-suspension")
"""Shipped cases without the actuators or gauges of a loop."""


def random_stage(seed):
    """A carriage on a soft guide, pushed by coils; a platform on it, read by gauges; one to four further bodies on either."""
    random = np.random.default_rng(seed)
    axes = int(random.integers(1, 3))
    masses = {"carriage": random.uniform(0.5, 3.0), PLATFORM: random.uniform(0.3, 3.0)}
    guided = _spring(random, sum(masses.values()), _between(random, 100.0, 800.0), soft=[_between(random, 1.0, 30.0) for _ in range(axes)])
    parts = {
        "guide": replace(guided, free=(Freedom.X, Freedom.Y)[:axes]),
        "coupling": replace(_spring(random, masses[PLATFORM], _between(random, 150.0, 3000.0)), free=()),
        "coil": VoiceCoil(force_constant=20.0, peak_current=5.0, mass=0.05),
    }
    links = {
        "guide": Link((GROUND, "carriage"), "guide", _place(random), X, bends=Z),
        "coupling": Link(("carriage", PLATFORM), "coupling", _place(random), X, bends=Z),
        **{f"coil{name}": Link((GROUND, "carriage"), "coil", _place(random), along) for name, along in (("x", X), ("y", Y))[:axes]},
    }
    for number in range(int(random.integers(1, 5))):
        onto, name = list(masses)[int(random.integers(len(masses)))], f"part{number}"
        masses[name] = random.uniform(0.02, 0.5)
        parts[name] = replace(_spring(random, masses[name], _between(random, 60.0, 4000.0)), free=())
        links[name] = Link((onto, name), name, _place(random), X, bends=Z)
    return Mechanism(
        name=f"random {seed}",
        materials={},
        parts=parts,
        bodies={
            name: Body(mass=float(mass), centre=_place(random), inertia=Inertia(*[9e-4 * float(mass)] * 3)) for name, mass in masses.items()
        },
        links=links,
        sensors={"scale": Encoder(range=10 * mm, period=1e-6, noise_density=1e-10)},
        gauges={f"S{name}": Probe("scale", PLATFORM, Pose(at=_place(random), along=along)) for name, along in (("x", X), ("y", Y))[:axes]},
        damping=ModalDamping(_between(random, 0.002, 0.02)),
    )


def _between(random, low, high):
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _place(random):
    return tuple(float(each) for each in random.uniform(-30.0, 30.0, 3) * mm)


def _spring(random, mass, frequency, soft=()):
    """Stiffnesses that make a mass resonate near a frequency along and about all axes, and at those of `soft` along the first ones."""
    stiffness = mass * (2.0 * np.pi * frequency) ** 2 * random.uniform(0.5, 2.0, 6) * np.array([1.0, 1.0, 1.0, 25e-4, 25e-4, 25e-4])
    stiffness[: len(soft)] = mass * (2.0 * np.pi * np.array(soft)) ** 2
    return Spring(diagonal=tuple(map(float, stiffness)))


def _figures(closed):
    """Peaks of S and T, and every margin of one loop at a time."""
    high, loops = peaks(closed, LoopBreak.POSE), margins(closed, LoopBreak.POSE, curves(closed, LoopBreak.POSE)).channels
    edges = (getattr(each, kind) for each in loops for kind in ("gain_low", "gain_high", "phase", "delay", "disk"))
    return np.array([high.sensitivity.value, high.complementary.value, *(edge.value for edge in edges)])


def _check(stage, setup=None):
    """Margins within 3 %, and the bandwidth within 10 %, of those with all modes."""
    given = resolve(stage, setup or LoopSetup(controller=ControllerSetup(quick=True)))
    gains = given.plant.coordinates.strokes
    few, control, found = control_and_modes(given, gains)
    assert found.complete
    assert set(mode_names(given.plant)) <= set(mode_names(few.plant))
    every = retain_modes(few, np.ones(found.total, dtype=bool))
    np.testing.assert_allclose(_figures(loop(few.plant, control.system)), _figures(loop(every.plant, control.system)), rtol=0.03)
    assert control.bandwidth == pytest.approx(make_controller(every, gains).bandwidth, rel=0.1)


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=[] if seed == 14 else pytest.mark.full) for seed in range(50)])
def test_margins_and_bandwidth_of_a_force_driven_stage_are_those_with_all_modes(seed):
    _check(random_stage(seed))


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[] if name in ("z-stage", "scanner") else pytest.mark.full) for name in CASES if name not in _OPEN],
)
def test_margins_and_bandwidth_of_a_shipped_case_are_those_with_all_modes(name):
    _check(case(name))


@pytest.mark.parametrize(("rate", "accuracy"), [(10e3, 0.05), (2e3, 0.2)])
def test_the_loop_gain_of_a_mode_left_out_is_the_difference_that_it_makes_to_the_sampled_plant(rate, accuracy, monkeypatch):
    """|dL S| at its resonance, from two discretised plants; with slow samples most modes are above half their rate, and broad."""
    setup = LoopSetup(
        rate=rate,
        amplifier=AmplifierSetup(bandwidth=1.5e3),
        gauges=GaugeSetup(bandwidth=2e3),
        controller=ControllerSetup(kind=ControllerKind.PID, proportional=300.0, integral=3e3, derivative=0.3, filter=500.0),
    )
    given = resolve(random_stage(3), setup)
    names = mode_names(given.whole)
    control = make_controller(given, given.plant.coordinates.strokes)
    # none is retained for its gain, nor for its ringing
    monkeypatch.setattr("flexstage.control.plant_models.retention.LOOP_GAINS", (np.inf,))
    monkeypatch.setattr("flexstage.control.plant_models.retention.RINGING", np.inf)
    compared = 0
    for left_out in np.argsort(-given.whole.frequencies)[::2]:
        wanted = np.ones(len(names), dtype=bool)
        wanted[left_out] = False
        few = reduce_modes(given.whole, wanted)
        closed = loop(few, control.system)
        found = retention(given.whole, closed)
        frequency, ratio = given.whole.frequencies[left_out], given.whole.ratios[left_out]
        lines = np.abs(frequency * (1.0 + ratio * np.linspace(-1.0, 1.0, 41)) - np.round(frequency / rate) * rate)
        loops = given.plant.coordinates
        both = [select(zero_order_hold(each), loops.actuators, [f"gap.{name}" for name in loops.gauges]) for each in (few, given.whole)]
        plants = [loops.pose @ each.transfer(lines) for each in both]
        feedback = pose_controller(closed.controller, loops).sweep(lines, slice(len(loops.names)))
        change = (plants[1] - plants[0]) @ feedback @ np.linalg.inv(np.eye(len(loops.names)) + plants[0] @ feedback)
        direct = np.max(np.linalg.norm(loops.scale[:, None] * change / loops.scale, 2, axis=(1, 2)))
        if direct > 1e-4:
            compared += 1
            assert found.gain == pytest.approx(direct, rel=accuracy)
    assert compared > 2


def test_a_mode_above_half_the_sampling_rate_is_retained_where_it_folds_into_the_loop():
    given = resolve(random_stage(3), LoopSetup(rate=2e3, controller=ControllerSetup(quick=True)))
    few, _, found = control_and_modes(given, given.plant.coordinates.strokes)
    assert np.max(few.plant.frequencies) > 1e3
    assert found.complete


def test_stated_modes_are_kept_to_and_what_they_hide_is_said_with_numbers():
    """Two modes of 24 are tuned to a peak of S of 6 dB; the warning has the peak with all that matter, as has the loop with all."""
    stage = random_stage(24)
    stated = loop_study(stage, LoopSetup(modes=2, controller=ControllerSetup(quick=True)))
    assert len(stated.plant.frequencies) == 2
    assert not stated.retention.complete
    (warning,) = [str(each) for each in stated.warnings if each.where == "modes"]
    every = loop(retain_modes(stated.settled, np.ones(24, dtype=bool)).plant, stated.controller.system)
    for closed in (stated.closed, every):
        assert f"the peak of S is {peaks(closed, LoopBreak.POSE).sensitivity.value:.3g}"[:-1] in warning
    with pytest.raises(DesignError, match="with all modes a pole at"):
        loop_study(stage, LoopSetup(modes=6, controller=ControllerSetup(quick=True)))
