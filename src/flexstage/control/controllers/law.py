"""What a law of one loop is: from a loop's error to its command, continuous or sampled."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array
from flexstage.base.record import Heading
from flexstage.control.systems.sampling import bilinear
from flexstage.control.systems.system import System
from flexstage.models.linear.model import Channel

ENTRIES = (Channel("error", "m"), Channel("pose", "m"), Channel("applied", "m"))
EXIT = (Channel("command", "m"),)
FIVE_DIGITS = Heading(digits=5)
"""How a law's numbers are shown."""


class Law(Protocol):
    """One loop's law.

    `system(step)` has the inputs `error` (reference less pose), `pose`, and `applied` (what the actuator was given less what was commanded:
    0 until something saturates; integrators are led back by it), and the output `command`. Without a step it is continuous.
    """

    def system(self, step: float | None = None) -> System:
        """The law as a system."""
        ...


def law_system(A: Array, B: Array, C: Array, D: Array, step: float | None, *, kept: Sequence[bool]) -> System:
    """A law's A (n, n), B (n, 3), C (1, n), D (1, 3) with the states that are `kept`: continuous, or by Tustin's rule.

    What was applied acts one sample later in a sampled law, because it is known only after the command.

    >>> one, none = np.eye(1), np.zeros((1, 3))
    >>> found = law_system(0.0 * one, np.array([[2.0, 0.0, 4.0]]), one, none, 0.1, kept=[True])
    >>> found.D.round(12).tolist()  # half a step of the error's rate 2 at once, nothing of what was applied
    [[0.1, 0.0, 0.0]]
    """
    places = np.flatnonzero(kept)
    found = System(A[np.ix_(places, places)], B[places], C[:, places], D, ENTRIES, EXIT)
    if step is None:
        return found
    found = bilinear(found, step)
    return replace(found, D=found.D * np.array([1.0, 1.0, 0.0]))


def gain_findings(kind: str, gains: Mapping[str, tuple[float, str]]) -> Iterator[Finding]:
    """Gains, with their units, that are negative or no numbers.

    >>> [str(each) for each in gain_findings("PI", {"integral": (-2.0, " 1/s")})]
    ['PI: integral is -2 1/s. Give 0 or more: the signs of gauges and actuators are in the stage already, so that every loop is positive.']
    """
    for name, (value, unit) in gains.items():
        if not 0.0 <= value < np.inf:
            advice = "Give 0 or more: the signs of gauges and actuators are in the stage already, so that every loop is positive"
            yield Finding(kind, f"{name} is {value:g}{unit}", advice)


def corner_findings(kind: str, noun: str, corner: float, step: float | None, otherwise: str = "") -> Iterator[Finding]:
    """A corner [Hz] of a law that the samples are too slow for.

    >>> [each.what for each in corner_findings("PID", "its filter at", 900.0, 1e-3)]
    ['its filter at 900 Hz is not below half the sampling rate, 500 Hz']
    """
    if step is not None and corner >= 0.5 / step:
        what = f"{noun} {corner:g} Hz is not below half the sampling rate, {0.5 / step:g} Hz"
        yield Finding(kind, what, f"Sample above {2.0 * corner:g} Hz{otherwise}")


def tracking_rate(time: float, step: float | None) -> float:
    """1/T_t [1/s] of a tracking time that follows from gains: not faster than one sample.

    >>> tracking_rate(0.5, None), tracking_rate(0.01, 0.1)
    (2.0, 10.0)
    """
    return 1.0 / (time if step is None else max(time, step))


def slow_tracking_findings(kind: str, time: float | None, step: float | None) -> Iterator[Finding]:
    """A stated tracking time [s] too short for the samples, shorter than one of them: an integrator led back would overshoot.

    >>> [each.what for each in slow_tracking_findings("PI", 1.0 / 3000.0, 1e-3)]
    ['tracking at 3000 1/s moves 3 of the way in one sample of 0.001 s, more than all of it']
    """
    if step is not None and time is not None and step / time > 1.0 + 1e-9:
        rate = 1.0 / time
        what = f"tracking at {rate:g} 1/s moves {rate * step:g} of the way in one sample of {step:g} s, more than all of it"
        yield Finding(kind, what, f"Sample at {rate:g} Hz or more, or state a longer time")
