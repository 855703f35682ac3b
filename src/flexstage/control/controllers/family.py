"""Families of single-loop controllers, from which tuning selects the best. Other packages can register more families."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.control.controllers.law import Law


@dataclass(frozen=True)
class Place:
    """Plant of one loop at the crossover `frequency` [Hz]: complex `gain` with notches, `static` gain, first `resonance` [Hz] if any."""

    frequency: float
    gain: complex
    static: float
    resonance: float | None


@dataclass(frozen=True)
class Family:
    """Controller family `name`: `laws` returns control laws C with a loop gain |C g| of 1 at the crossover of a plant g.

    The arguments of `laws` are a `Place` and the sampling interval [s] (None: continuous). For each loop, tuning selects the law with the
    lowest peak of the sensitivity S. If `notched` is true, tuning adds notches at modes that need them. If no law meets the specification,
    the error message suggests the kinds of controllers in `others`. `steps` are two ratios of successive trial bandwidths, for bandwidths
    above and below 5 % of the first mode's frequency.
    """

    name: str
    laws: Callable[[Place, float | None], Sequence[Law]]
    notched: bool = True
    others: str = "PID or LQG"
    steps: tuple[float, float] = (1.3, 2.0)


def tracking_gain(place: Place, turning: float, feedback: complex) -> float | None:
    """Solve |k/s - Q| |g| = 1 at s = j `turning` for the integral gain k [1/s].

    Q is the `feedback` of the pose, and g is the plant's complex gain at the crossover. Returns None if no k > 0 solves the equation.

    >>> round(tracking_gain(Place(1.0, 0.5 + 0.0j, 1.0, None), 2.0, 0.0j), 9)
    4.0
    """
    rest = 1.0 / abs(place.gain) ** 2 - feedback.real**2
    if not (rest > 0.0 and np.sqrt(rest) > feedback.imag):
        return None
    return turning * float(np.sqrt(rest) - feedback.imag)


def warped(frequency: float, step: float | None) -> float:
    """Compute the angular frequency [1/s] that Tustin's rule maps to a `frequency` [Hz] (prewarping)."""
    return 2.0 * np.pi * frequency if step is None else float(2.0 / step * np.tan(np.pi * frequency * step))
