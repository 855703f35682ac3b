"""Random plants and controllers for the laws of loops: modes, lags and delays drawn, no stage behind them."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Table
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.plant_models.electronics import Amplifier, Hardware, Sensor
from flexstage.control.plant_models.plants import Plant
from flexstage.control.systems.closed import Loop, loop
from flexstage.control.systems.system import System
from flexstage.models.linear.model import Channel

RATE = 1000.0


def random_plant(seed, *, rate=RATE, delay=None, modes=3, coordinates=None, lagged=True):
    """Modes between 20 and 400 Hz, one to three coordinates, as many or more actuators and gauges.

    Amplifiers are `lagged`; those that are not are felt at once by a static term, as of modes left out.
    """
    random = np.random.default_rng(seed)
    count = coordinates or int(random.integers(1, 4))
    wide, tall = count + int(random.integers(0, 2)), count + int(random.integers(0, 2))
    actuators, gauges = tuple(f"B{number + 1}" for number in range(wide)), tuple(f"S{number + 1}" for number in range(tall))
    names, units = ("x", "y", "rz")[:count], ("m", "m", "rad")[:count]
    seen, driven = (
        random.normal(size=(tall, count)) + 2.0 * np.eye(tall, count),
        random.normal(size=(count, wide)) + 2.0 * np.eye(count, wide),
    )
    frequencies, ratios, shapes = _modes(random, modes, count)
    A, B, C = _modal(2.0 * np.pi * frequencies, ratios, shapes, (seen, np.hstack([driven, random.normal(size=(count, count))])))
    D, states = np.zeros((len(C), B.shape[1])), [f"mode{number + 1}{mark}" for mark in ("", "'") for number in range(modes)]
    if lagged:
        A, B, states = _with_lag(A, B, wide, 2.0 * np.pi * random.uniform(100.0, 800.0), states, actuators)
        C = np.hstack([C, np.zeros((len(C), wide))])
    else:
        D[:, :wide] = 0.2 * np.vstack([seen, np.eye(count)]) @ random.normal(size=(count, wide))
    inputs = [Channel(name, "m") for name in actuators] + [Channel(f"ground.{name}", unit) for name, unit in zip(names, units, strict=True)]
    poses = [Channel(f"relative.{name}", unit) for name, unit in zip(names, units, strict=True)]
    static = shapes @ shapes.T @ driven + D[tall:, :wide]
    return Plant(
        system=System(A, B, C, D, tuple(inputs), (*(Channel(f"gap.{name}", "m") for name in gauges), *poses)),
        states=tuple(states),
        coordinates=Coordinates(names, units, actuators, gauges, np.linalg.pinv(seen), np.linalg.pinv(static), static, 0.1),
        hardware=_hardware(random, rate, delay, (actuators, gauges)),
        frequencies=frequencies,
        ratios=ratios,
        left_out=0,
        note="random",
        provenance="random",
    )


def _modes(random, modes, count):
    return np.sort(random.uniform(20.0, 400.0, modes)), random.uniform(0.005, 0.1, modes), random.normal(size=(count, modes))


def _modal(omega, ratios, shapes, maps):
    """Modes with unit static gain each, between strokes and ground, and gauges and pose."""
    (seen, driven), modes = maps, len(omega)
    A = np.block([[np.zeros((modes, modes)), np.eye(modes)], [-np.diag(omega**2), -np.diag(2.0 * ratios * omega)]])
    B = np.vstack([np.zeros((modes, driven.shape[1])), omega[:, None] ** 2 * (shapes.T @ driven)])
    C = np.vstack([seen @ shapes, shapes])
    return A, B, np.hstack([C, np.zeros_like(C)])


def _with_lag(A, B, wide, bandwidth, states, actuators):
    lag = -bandwidth * np.eye(wide)
    A = np.block([[A, B[:, :wide]], [np.zeros((wide, len(A))), lag]])
    entry = np.vstack([B, np.zeros((wide, B.shape[1]))])
    entry[:, :wide] = np.vstack([np.zeros((len(B), wide)), bandwidth * np.eye(wide)])
    return A, entry, [*states, *(f"amplifier.{name}" for name in actuators)]


def _hardware(random, rate, delay, names):
    actuators, gauges = names
    delay = float(random.uniform(0.0, 2.5)) / RATE if delay is None else delay
    return Hardware(
        rate,
        delay if rate else 0.0,
        Table({name: Amplifier(noise_density=1e-12 * random.uniform(0.5, 2.0), step=1e-10) for name in actuators}),
        Table({name: Sensor(noise_density=1e-12 * random.uniform(0.5, 2.0), resolution=1e-10) for name in gauges}),
    )


def random_controller(plant, seed, gain=1.0):
    """An integral controller through the static inverse, beside it a random filter of two states; `gain` multiplies all."""
    random = np.random.default_rng(seed)
    coordinates, step = plant.coordinates, plant.hardware.step
    count, wide = len(coordinates.names), len(coordinates.actuators)
    rate = gain * float(random.uniform(5.0, 60.0))
    slow, mixed = random.uniform(50.0, 500.0, 2), 0.2 * gain * random.normal(size=(2, count))
    inputs = tuple(Channel(f"error.{name}", unit) for name, unit in zip(coordinates.names, coordinates.units, strict=True))
    outputs = tuple(Channel(f"command.{name}", "m") for name in coordinates.actuators)
    A = np.diag([*np.zeros(count), *-slow])
    B = np.vstack([np.eye(count), slow[:, None] * mixed])
    C = np.hstack([rate * coordinates.strokes, 0.3 * random.normal(size=(wide, 2))])
    D = np.zeros((wide, count))
    if step is None:
        return System(A, B, C, D, inputs, outputs)
    poles = np.exp(np.diag(A) * step)
    held = np.where(np.diag(A) == 0.0, step, (1.0 - poles) / np.where(np.diag(A) == 0.0, 1.0, -np.diag(A)))
    return System(np.diag(poles), held[:, None] * B, C, D, inputs, outputs, step)


def random_loop(seed, *, gain=1.0, **settings):
    """A random plant under a random controller: some are stable."""
    plant = random_plant(seed, **settings)
    return loop(plant, random_controller(plant, seed + 1, gain))


def stable_loop(seed, **settings) -> Loop:
    """A random loop, its gain halved until all poles decay, as they do when it is small enough."""
    gain = 1.0
    while (found := random_loop(seed, gain=gain, **settings)).system.growth > -0.1 * gain:
        gain *= 0.5
    return found
