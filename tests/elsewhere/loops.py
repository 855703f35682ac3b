"""Loops that other programs compute as well: the shipped stage, six axes, amplifiers with lags, gauges with lags."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from flexstage.analysis.workspace.drive import Drive, drive
from flexstage.cases.double_triangle import double_triangle
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.loops import platform_loops
from flexstage.control.controllers.pi import PI
from flexstage.control.example import integral
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.plant_models.electronics import AmplifierSettings, sampling_chain
from flexstage.control.plant_models.plants import plant
from flexstage.control.simulation.machine import Machine, machine
from flexstage.control.systems.closed import Loop, loop
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped

RATE = 10e3
PLATFORM = ("platform.x", "platform.y", "platform.z", "platform.rx", "platform.ry", "platform.rz")


@cache
def stage() -> Mechanism:
    return double_triangle()


@cache
def electric() -> Drive:
    return drive(stage())


def six_axes(modes: int = 12, gain: float = 10.0, delay: float = 80e-6, current: float = 0.1) -> Loop:
    """Integral control of all six axes, stable: the stage's modes are damped by 1 % and stay below 0 dB."""
    settings = AmplifierSettings(resistance=100.0, current=current, bits=18)
    given = sampling_chain(stage(), rate=RATE, delay=delay, amplifiers=settings)
    one = plant(lumped(stage()), ideal(stage()), given, modes=modes)
    return loop(one, integral(one, gain))


def plays(operators: int = 10, width: float = 0.15) -> PrandtlIshlinskii:
    """A hysteresis of every stack: thresholds over 400 V, and weights that widen with them, 15 % of the stroke."""
    thresholds = np.linspace(0.0, 400.0, operators)
    shares = np.concatenate([[1.0 - width * 2.0], np.full(operators - 1, width * 2.0 / (operators - 1))])
    return PrandtlIshlinskii(np.tile(thresholds, (6, 1)), electric().gain[:, None] * shares)


def full_loop(*, inverse: bool = False, current: float = 0.02, motions: tuple[str, ...] | None = None) -> Machine:
    """PI control of six axes with everything that is not linear: hysteresis, its inverse, limits, converters, rounding gauges."""
    wired = six_axes(current=current)
    loops = platform_loops(wired.plant.coordinates)
    control = Decentralised(loops, (PI(0.02, 8.0),) * 6, feedforward=wired.plant.coordinates.strokes).system(1.0 / RATE)
    stacks = plays()
    return machine(wired.plant, control, electric(), hysteresis=stacks, compensation=stacks if inverse else None, motions=motions)


def way(given: Machine, count: int, size: float = 20e-6) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """A reference of steps and sines on all axes, and disturbances of every kind, all known."""
    times = given.step * np.arange(count)
    phases = np.arange(6)
    amplitudes = size * np.array([1.0, 0.7, 0.3, 2.0, 2.0, 3.0])
    reference = amplitudes * np.sin(2.0 * np.pi * (20.0 + 5.0 * phases) * times[:, None] + phases)
    reference[count // 2 :, 0] += 2.0 * size
    random = np.random.default_rng(11)
    named = {f"noise.{gauge}": 2e-9 * random.standard_normal(count) for gauge in given.gauges}
    named |= {f"noise.{actuator}": 1e-9 * random.standard_normal(count) for actuator in given.actuators}
    named |= {"ground.x": 1e-6 * np.sin(2.0 * np.pi * 60.0 * times), "ground.rz": 1e-7 * np.sin(2.0 * np.pi * 45.0 * times)}
    return reference, {**named, "platform.fz": 5.0 * (times > 0.3 * times[-1])}


def without_limits(given: Machine) -> Machine:
    """The same machine without anything that is not linear: no limits and ranges, no rounding, no hysteresis and no inverse.

    >>> from flexstage.control.example import integral_loop
    >>> example = integral_loop()
    >>> bool(np.isinf(without_limits(machine(example.plant, example.controller)).amplifiers.high[0]))
    True
    """
    count = len(given.actuators)
    free = replace(
        given.amplifiers,
        low=np.full(count, -np.inf),
        high=np.full(count, np.inf),
        slew=np.full(count, np.inf),
        step=np.zeros(count),
    )
    resolution = np.zeros(len(given.gauges))
    return replace(given, amplifiers=free, resolution=resolution, hysteresis=None, compensation=None, half_range=None, relief=None)
