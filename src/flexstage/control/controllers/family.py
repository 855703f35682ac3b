"""Kinds of controllers made of single loops: families of laws, of which tuning takes the best. Other packages offer theirs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.control.controllers.law import Law


@dataclass(frozen=True)
class Place:
    """Where a law shall pass: the loop's complex `gain` at `frequency` [Hz] with notches; its `static` gain, first `resonance` [Hz]."""

    frequency: float
    gain: complex
    static: float
    resonance: float | None


@dataclass(frozen=True)
class Family:
    """A kind of controller by its `name` in words: its `laws` with |C g| = 1 at a place, sampled every so many seconds (None: not).

    Of them tuning takes, loop by loop, the one with the lowest peak of S. `notched`: notches behind it are placed on modes that need them.
    `others`: what to try where it does not reach what is wanted. `steps` are the ratios of bandwidths tried in turn, above 0.05 of the
    first mode and below, where less depends on them.
    """

    name: str
    laws: Callable[[Place, float | None], Sequence[Law]]
    notched: bool = True
    others: str = "PID or LQG"
    steps: tuple[float, float] = (1.3, 2.0)


def tracking_gain(place: Place, turning: float, feedback: complex) -> float | None:
    """The integral gain k [1/s] with |k/s - Q| |g| = 1 for feedback Q of the pose at a place, s = j `turning`; None where there is none.

    >>> round(tracking_gain(Place(1.0, 0.5 + 0.0j, 1.0, None), 2.0, 0.0j), 9)
    4.0
    """
    rest = 1.0 / abs(place.gain) ** 2 - feedback.real**2
    if not (rest > 0.0 and np.sqrt(rest) > feedback.imag):
        return None
    return turning * float(np.sqrt(rest) - feedback.imag)


def warped(frequency: float, step: float | None) -> float:
    """The angular frequency [1/s] at which a continuous law is what its samples by Tustin's rule are at a frequency [Hz]."""
    return 2.0 * np.pi * frequency if step is None else float(2.0 / step * np.tan(np.pi * frequency * step))
