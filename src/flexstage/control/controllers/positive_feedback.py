"""Positive position feedback (PPF) and positive velocity feedback: a resonant filter damps one mode, inside an integral loop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexstage.base.finding import require
from flexstage.base.record import Heading
from flexstage.base.units.quantity import FREQUENCY, RATE
from flexstage.control.controllers.family import Family, Place, tracking_gain, warped
from flexstage.control.controllers.law import FIVE_DIGITS, corner_findings, law_system, positive_findings, tracking_rate
from flexstage.control.systems.system import System

_POSITIONS = (0.25, 0.5, 0.78)
_DAMPINGS = (0.45, 0.85)
_PLACED = (0.1, 0.2, 0.3)
_OF_RATE = 0.4


@dataclass(frozen=True)
class PositiveFeedback:
    """Positive position and velocity feedback around an integrator: u = (v s + b w^2) / (s^2 + 2 z w s + w^2) y + (k_t / s) e.

    y is the loop's pose [m], e its error, u its command. The fields are `position` b [1], `velocity` v [1/s], `frequency` w / (2 pi) [Hz],
    `damping` z and `tracking` k_t [1/s]. Without v, the law is positive position feedback (Fanson & Caughey, AIAA Journal 28 (1990) 717).
    This feedback of an undamped mode with the static gain g is stable if b g < 1. With v, the law is positive velocity and position
    feedback (Bhikkaji, Ratnam, Fleming & Moheimani, IEEE Transactions on Control Systems Technology 15 (2007) 853). Raises `DesignError`
    for invalid numbers.

    >>> control = PositiveFeedback(position=0.8, frequency=100.0, damping=0.8)
    >>> control.system().transfer(np.array([1e-3]))[0, 0, 1].real.round(6).item()  # b at rest
    0.8
    """

    position: Annotated[float, FIVE_DIGITS]
    frequency: Annotated[float, FREQUENCY, FIVE_DIGITS]
    damping: Annotated[float, Heading("filter damping", digits=5)]
    velocity: Annotated[float, RATE, FIVE_DIGITS] = 0.0
    tracking: Annotated[float, RATE, FIVE_DIGITS] = 0.0

    def __post_init__(self) -> None:
        require(positive_findings("positive feedback", {"frequency": self.frequency, "damping": self.damping}))

    def system(self, step: float | None = None) -> System:
        """Return the linear system (see `Law`), discretised by Tustin's rule.

        Raises `DesignError` for a filter above half the sampling rate.
        """
        require(corner_findings("positive feedback", "its filter at", self.frequency, step))
        w = 2.0 * np.pi * self.frequency
        A = np.array([[0.0, 1.0, 0.0], [-(w**2), -2.0 * self.damping * w, 0.0], [0.0, 0.0, 0.0]])
        back = 0.0 if not self.tracking else tracking_rate(1.0 / self.tracking, step)
        B = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [self.tracking, 0.0, back]])
        C = np.array([[self.position * w**2, self.velocity, 1.0]])
        return law_system(A, B, C, np.zeros((1, 3)), step, kept=[True, True, self.tracking != 0.0])

    def feedback(self, rate: complex) -> complex:
        """Compute the filter's transfer function from pose to command at a complex frequency s [1/s]."""
        w = 2.0 * np.pi * self.frequency
        return (self.velocity * rate + self.position * w**2) / (rate**2 + 2.0 * self.damping * w * rate + w**2)


def place_poles(frequency: float, damping: float, static: float = 1.0) -> PositiveFeedback:
    """Place the poles of an undamped mode and of the filter at the roots of (s^2 + 2 sigma s + sigma^2 + w^2)^2, sigma = `damping` w.

    The mode is w^2 g / (s^2 + w^2), with w = 2 pi `frequency` and g = `static`. Both pole pairs get the damped frequency w and the decay
    rate sigma. The filter's four parameters determine the four poles (Bhikkaji, Ratnam, Fleming & Moheimani 2007).

    >>> law = place_poles(100.0, 0.2)
    >>> w = 200.0 * np.pi
    >>> at = w * (-0.2 + 1.0j)
    >>> bool(abs(at**2 + w**2 - w**2 * law.feedback(at)) < 1e-9 * w**2)  # a pole of mode and filter
    True
    """
    w = 2.0 * np.pi * frequency
    sigma = damping * w
    cubic, square, linear, constant = np.polymul([1.0, 2.0 * sigma, sigma**2 + w**2], [1.0, 2.0 * sigma, sigma**2 + w**2])[1:]
    own = square - w**2
    velocity = (cubic * w**2 - linear) / (static * w**2)
    position = (own * w**2 - constant) / (static * w**2 * own)
    turning = float(np.sqrt(own))
    return PositiveFeedback(float(position), turning / (2.0 * np.pi), float(0.5 * cubic / turning), float(velocity))


def position_laws(place: Place, step: float | None) -> list[PositiveFeedback]:
    """Design positive position feedback of the first resonance for several static loop gains and damping ratios."""
    return _tracking(
        place,
        step,
        lambda frequency, static: [PositiveFeedback(share / static, frequency, damping) for share in _POSITIONS for damping in _DAMPINGS],
    )


def velocity_laws(place: Place, step: float | None) -> list[PositiveFeedback]:
    """Design positive velocity and position feedback of the first resonance for several damping ratios."""
    return _tracking(place, step, lambda frequency, static: [place_poles(frequency, damping, static) for damping in _PLACED])


def _tracking(place: Place, step: float | None, filters: Callable[[float, float], list[PositiveFeedback]]) -> list[PositiveFeedback]:
    """Laws whose integrator reaches |C g| = 1 at the crossover, with `filters` for the first resonance [Hz] and the static gain."""
    if place.resonance is None or not place.static > 0.0:
        return []
    turning = warped(place.frequency, step)
    usable = [each for each in filters(place.resonance, place.static) if step is None or each.frequency <= _OF_RATE / step]
    gains = [tracking_gain(place, turning, each.feedback(1j * turning)) for each in usable]
    return [replace(each, tracking=gain) for each, gain in zip(usable, gains, strict=True) if gain is not None]


PPF = Family("positive position feedback", position_laws, notched=False, others="PI with notches, LQG, or force feedback in the legs")
PVF = Family("positive velocity feedback", velocity_laws, notched=False, others="PI with notches, LQG, or force feedback in the legs")
