"""Records and responses whose numbers, names and units need care."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.record import Channel, InMemory, Record, Responses, Role

NAMES = ("u1", "B4/pivot.mz", "S1", "förder weg", 'gauge "a", left', "x [mm]")
UNITS = ("V", "N m", "um", "nm", "", "m/s^2")
ROLES = (Role.INPUT, Role.INPUT, Role.OUTPUT, Role.OUTPUT, Role.UNKNOWN, Role.OUTPUT)


def awkward(seed: int, *shape: int) -> Array:
    """Numbers over the whole range of doubles, signed zeros and the smallest one among them."""
    draw = np.random.default_rng(seed)
    values = draw.standard_normal(shape) * 10.0 ** draw.integers(-300, 300, shape)
    special = [0.0, -0.0, 5e-324, 1.7976931348623157e308, -1.0 / 3.0]
    values.ravel()[: min(5, values.size)] = special[: min(5, values.size)]
    return values


def awkward_record(seed: int = 0, length: int = 1000, rate: float = 2048.0 / 3.0, start: float = -0.1) -> Record:
    channels = tuple(Channel(name, unit, role) for name, unit, role in zip(NAMES, UNITS, ROLES, strict=True))
    return Record(channels, rate, InMemory(awkward(seed, length, len(channels))), start, name="stage 1, run 2")


def awkward_responses(seed: int = 0, *, even: bool = True, coherence: bool = True) -> Responses:
    draw = np.random.default_rng(seed)
    frequencies = 3.0 + 0.3125 * np.arange(40) if even else np.cumsum(0.1 + draw.random(40))
    outputs = tuple(Channel(name, unit, Role.OUTPUT) for name, unit in zip(NAMES[2:], UNITS[2:], strict=True))
    inputs = tuple(Channel(name, unit, Role.INPUT) for name, unit in zip(NAMES[:2], UNITS[:2], strict=True))
    values = np.ascontiguousarray(awkward(seed, 40, 4, 4)).view(complex)
    shares = draw.random((40, 4, 2)) if coherence else None
    return Responses(frequencies, outputs, inputs, values, shares, window="hann", averages=12, name="analyser")


def bits(values: Array) -> bytes:
    return np.ascontiguousarray(values).tobytes()
