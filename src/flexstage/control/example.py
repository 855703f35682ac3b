"""A small loop for examples and tests: one axis, an integral controller."""

from __future__ import annotations

import numpy as np

from flexstage.cases.parallelogram import parallelogram
from flexstage.control.plant_models.electronics import Hardware, sampling_chain
from flexstage.control.plant_models.plants import Plant, plant
from flexstage.control.systems.closed import Loop, loop
from flexstage.control.systems.system import System
from flexstage.models.ideal import ideal
from flexstage.models.linear.model import Channel
from flexstage.models.lumped import lumped


def integral(given: Plant, gain: float) -> System:
    """Construct an integral controller of all coordinates, sampled by the backward rectangle rule: u' = `gain` [1/s] R_a e.

    u are the commands, e the errors of the coordinates, and R_a the strokes per unit of each coordinate.

    >>> found = integral(integral_loop().plant, 100.0)
    >>> found.input_names, found.D.tolist()  # 100/s for 0.1 ms
    (('error.x',), [[0.01]])
    """
    strokes, step, units = given.coordinates.strokes, given.hardware.step, given.coordinates.units
    count = strokes.shape[1]
    inputs = tuple(Channel(f"error.{name}", unit) for name, unit in zip(given.coordinates.names, units, strict=True))
    outputs = given.coordinates.commands("command.")
    if step is None:
        return System(np.zeros((count, count)), np.eye(count), gain * strokes, np.zeros_like(strokes), inputs, outputs)
    return System(np.eye(count), np.eye(count), gain * step * strokes, gain * step * strokes, inputs, outputs, step)


def integral_loop(gain: float = 100.0, given: Hardware | None = None) -> Loop:
    """Close an integral loop around the lumped model of the shipped parallelogram: three modes, 10 kHz sampling, half a sample of delay.

    >>> integral_loop().system.growth < 0.0
    True
    """
    stage = parallelogram()
    given = sampling_chain(stage, rate=10e3, delay=50e-6) if given is None else given
    one = plant(lumped(stage), ideal(stage), given, modes=3)
    return loop(one, integral(one, gain))
