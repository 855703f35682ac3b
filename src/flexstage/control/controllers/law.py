"""Protocol of a single-loop controller: from loop error to command, continuous or sampled."""

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
"""Format of a law's printed numbers."""


class Law(Protocol):
    """Single-loop controller.

    The inputs of `system(step)` are `error` (reference minus pose), `pose`, and `applied` for anti-windup (applied minus commanded input, 0
    without saturation). The only output of `system(step)` is `command`. Without a step the system is continuous.
    """

    def system(self, step: float | None = None) -> System:
        """Return the controller as a linear system."""
        ...


def law_system(A: Array, B: Array, C: Array, D: Array, step: float | None, *, kept: Sequence[bool]) -> System:
    """Construct a control law's system from A (n, n), B (n, 3), C (1, n), D (1, 3); with `step` [s] it is discretised by Tustin's rule.

    The inputs are those of `Law`. Only states marked in `kept` remain. In a sampled law the applied input acts one sample later, because it
    is known only after the command.

    >>> one, none = np.eye(1), np.zeros((1, 3))
    >>> found = law_system(0.0 * one, np.array([[2.0, 0.0, 4.0]]), one, none, 0.1, kept=[True])
    >>> found.D.round(12).tolist()  # error: half a step of the rate 2; applied input: no direct term
    [[0.1, 0.0, 0.0]]
    """
    places = np.flatnonzero(kept)
    found = System(A[np.ix_(places, places)], B[places], C[:, places], D, ENTRIES, EXIT)
    if step is None:
        return found
    found = bilinear(found, step)
    return replace(found, D=found.D * np.array([1.0, 1.0, 0.0]))


def gain_findings(kind: str, gains: Mapping[str, tuple[float, str]]) -> Iterator[Finding]:
    """Return a finding for each gain (with its unit) that is negative or not finite.

    >>> [str(each) for each in gain_findings("PI", {"integral": (-2.0, " 1/s")})]
    ['PI: integral is -2 1/s. Use 0 or more: the model already includes the signs of gauges and actuators.']
    """
    for name, (value, unit) in gains.items():
        if not 0.0 <= value < np.inf:
            advice = "Use 0 or more: the model already includes the signs of gauges and actuators"
            yield Finding(kind, f"{name} is {value:g}{unit}", advice)


def positive_findings(kind: str, numbers: Mapping[str, float | None]) -> Iterator[Finding]:
    """Return a finding for each number that is not positive; None is accepted.

    >>> [str(each) for each in positive_findings("notch", {"damping": 0.0})]
    ['notch: damping must be positive (got 0). Use a positive number.']
    """
    for name, value in numbers.items():
        if value is not None and not value > 0.0:
            yield Finding(kind, f"{name} must be positive (got {value:g})", "Use a positive number")


def corner_findings(kind: str, noun: str, corner: float, step: float | None, otherwise: str = "") -> Iterator[Finding]:
    """Return a finding if a corner frequency [Hz] of a law is not below half the sampling rate.

    >>> [each.what for each in corner_findings("PID", "its filter at", 900.0, 1e-3)]
    ['its filter at 900 Hz is not below half the sampling rate, 500 Hz']
    """
    if step is not None and corner >= 0.5 / step:
        what = f"{noun} {corner:g} Hz is not below half the sampling rate, {0.5 / step:g} Hz"
        yield Finding(kind, what, f"Sample above {2.0 * corner:g} Hz{otherwise}")


def tracking_rate(time: float, step: float | None) -> float:
    """Compute the anti-windup rate 1/T_t [1/s] from a tracking time T_t [s]. One sample replaces a shorter tracking time.

    >>> tracking_rate(0.5, None), tracking_rate(0.01, 0.1)
    (2.0, 10.0)
    """
    return 1.0 / (time if step is None else max(time, step))


def slow_tracking_findings(kind: str, time: float | None, step: float | None) -> Iterator[Finding]:
    """Return a finding if a tracking time [s] is shorter than a sample: the anti-windup would overshoot.

    >>> [each.what for each in slow_tracking_findings("PI", 1.0 / 3000.0, 1e-3)]
    ['tracking rate 3000 1/s is too high (expected at most 1000 1/s, the sampling rate)']
    """
    if step is not None and time is not None and step / time > 1.0 + 1e-9:
        rate = 1.0 / time
        what = f"tracking rate {rate:g} 1/s is too high (expected at most {1.0 / step:g} 1/s, the sampling rate)"
        yield Finding(kind, what, f"Sample at {rate:g} Hz or more, or use a longer tracking time")
