"""Integral resonant control: an integrator around the plant with feed-through damps its resonance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, require
from flexstage.base.record import Heading
from flexstage.base.units.quantity import RATE, TIME
from flexstage.control.controllers.law import (
    FIVE_DIGITS,
    corner_findings,
    gain_findings,
    law_system,
    positive_findings,
    slow_tracking_findings,
    tracking_rate,
)
from flexstage.control.systems.system import System


@dataclass(frozen=True)
class IntegralResonant(CheckedFields):
    """Integral resonant control u = Q(s) y + (k_t / s) e, Q(s) = k / (s + k d): damping by positive feedback, tracking by an integrator.

    The command u [m] of the loop is computed from the pose y [m] and the error e [m] of the loop. The fields are `gain` k [1/s],
    `feedthrough` d [1] and `tracking` k_t [1/s]. The feed-through d is positive, and it is subtracted from the plant G. An integrator -k/s
    in feedback around G - d is equivalent to Q in feedback around G (Aphale, Fleming & Moheimani 2007; Fleming, Aphale & Moheimani 2010).
    The static gain of Q is 1/d; therefore the loop is stable only if d exceeds the plant's static gain. The anti-windup time is
    `tracking_time` [s], by default 1/k_t. Raises `DesignError` for negative gains, and for a feed-through that is not positive.

    >>> control = IntegralResonant(gain=1000.0, feedthrough=2.0, tracking=100.0)
    >>> control.system().transfer(np.array([0.0001]))[0, 0, 1].real.round(6).item()  # 1/d at rest
    0.5
    """

    gain: Annotated[float, RATE, FIVE_DIGITS]
    feedthrough: Annotated[float, Heading("feed-through", digits=5)]
    tracking: Annotated[float, RATE, FIVE_DIGITS] = 0.0
    tracking_time: Annotated[float | None, TIME] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        found = list(gain_findings("integral resonant control", {"gain": (self.gain, " 1/s"), "tracking": (self.tracking, " 1/s")}))
        if not 0.0 < self.feedthrough < np.inf:
            advice = "Use a value above the plant's static gain, e.g. twice that gain"
            found.append(Finding("integral resonant control", f"feed-through must be positive (got {self.feedthrough:g})", advice))
        require(found)

    def system(self, step: float | None = None) -> System:
        """Return the linear system (see `Law`), discretised by Tustin's rule.

        Raises `DesignError` if the corner k d/(2 pi) of Q is not below half the sampling rate, and for a tracking time below one sample.
        """
        pole = self.gain * self.feedthrough
        require(slow_tracking_findings("integral resonant control", self.tracking_time, step))
        require(corner_findings("integral resonant control", "its corner k d / (2 pi) =", pole / (2.0 * np.pi), step))
        A, C = np.diag([-pole, 0.0]), np.ones((1, 2))
        B = np.array([[0.0, self.gain, 0.0], [self.tracking, 0.0, self._tracking_rate(step)]])
        return law_system(A, B, C, np.zeros((1, 3)), step, kept=[self.gain > 0.0, self.tracking > 0.0])

    def _tracking_rate(self, step: float | None) -> float:
        if not self.tracking:
            return 0.0
        return tracking_rate(1.0 / self.tracking if self.tracking_time is None else self.tracking_time, step)


def resonant_law(frequency: float, damping: float, static: float = 1.0, tracking: float = 0.0) -> IntegralResonant:
    """Compute gains that damp an undamped mode at `frequency` [Hz] to the damping ratio zeta = `damping`.

    With the feed-through d, zeta is the largest damping ratio that any gain k reaches. The mode's angular frequency is w_p, and the plant's
    static gain is g = `static`. Then k d = w_p (1 + 2 zeta)^(1/2) and d = g (1 + 2 zeta)^2 / ((1 + 2 zeta)^2 - 1) (Namavar, Fleming &
    Aphale 2014). The gain k_t [1/s] is `tracking`. Raises `DesignError` for numbers that are not positive.

    >>> control = resonant_law(100.0, damping=0.5 * (2.0**0.5 - 1.0))
    >>> round(control.feedthrough, 9), round(control.gain * control.feedthrough / (200.0 * np.pi), 4)  # 2, and 2^(1/4)
    (2.0, 1.1892)
    """
    require(positive_findings("resonance", {"frequency": frequency, "damping": damping, "static gain": static}))
    ratio = 1.0 + 2.0 * damping
    feedthrough = static * ratio**2 / (ratio**2 - 1.0)
    return IntegralResonant(2.0 * math.pi * frequency * math.sqrt(ratio) / feedthrough, feedthrough, tracking)
