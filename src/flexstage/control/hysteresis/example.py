"""Example test of a stack. It is simulated with a Bouc-Wen model, which no play model reproduces exactly."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from flexstage.base.number import Array
from flexstage.control.hysteresis.creep import LogCreep
from flexstage.control.hysteresis.models.bouc_wen import bouc_wen
from flexstage.control.hysteresis.stack_test import StackTest, stack_test
from flexstage.experiment.records.record import Channel, Record, Role, in_memory

_TURNS = (0, 1000, 0, 1000, 100, 900, 200, 800, 300, 700, 400, 600, 500, 1000, 0, 700, 0, 400, 0)
_CHANNELS = (Channel("u", "V", Role.INPUT), Channel("y", "um", Role.OUTPUT))
_RATE = 100.0


def sweep_of(turns: tuple[float, ...], samples: int) -> Array:
    """Return a piecewise linear voltage (k,) between turning points, with `samples` per segment.

    >>> sweep_of((0.0, 2.0, 0.0), 2).tolist()
    [0.0, 1.0, 2.0, 1.0, 0.0]
    """
    legs = [np.linspace(start, stop, samples + 1)[1:] for start, stop in pairwise(turns)]
    return np.concatenate([np.array(turns[:1], dtype=float), *legs])


def example_record() -> Record:
    """Simulate a record of hysteresis loops: stroke 150 um at 1000 V, loop width 15 % of the stroke, gauge noise 10 nm.

    >>> example_record().length
    901
    """
    volts = sweep_of(_TURNS, 50)
    strokes = bouc_wen(150e-6, (0.0, 1000.0), 0.15).run(volts)
    noise = 0.01 * np.random.default_rng(0).normal(size=len(volts))
    return in_memory(_CHANNELS, _RATE, np.column_stack([volts, 1e6 * strokes + noise]))


def example_step() -> Record:
    """Simulate a record of a step of 500 V for 100 s, with creep of 2 % per decade.

    >>> example_step().duration
    101.0
    """
    times = np.arange(0.0, 101.0, 1.0 / _RATE)
    strokes = np.where(times < 1.0, 0.0, 70.0 * LogCreep(0.02).at(np.maximum(times - 1.0, 1e-3)))
    noise = 0.01 * np.random.default_rng(1).normal(size=len(times))
    return in_memory(_CHANNELS, _RATE, np.column_stack([np.where(times < 1.0, 0.0, 500.0), strokes + noise]))


@cache
def example_test() -> StackTest:
    """Return the test identified from the records `example_record` and `example_step`; it is computed once.

    >>> test = example_test()
    >>> round(test.hysteresis.width, 2), round(test.creep.law.rate, 3)
    (0.15, 0.02)
    """
    return stack_test(example_record(), step=example_step())
