"""Proportional, integral and filtered derivative control."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, require
from flexstage.base.units.quantity import FREQUENCY, RATE, SHORT_TIME, TIME
from flexstage.control.controllers.law import FIVE_DIGITS, corner_findings, gain_findings, law_system, slow_tracking_findings, tracking_rate
from flexstage.control.controllers.pi import PI, tracking_findings
from flexstage.control.systems.system import System


@dataclass(frozen=True)
class PID(CheckedFields):
    """PID controller k_p + k_i/s + k_d s/(1 + s/(2 pi f)) from a loop's error [m] to its command [m].

    The gains are `proportional` k_p [1], `integral` k_i [1/s] and `derivative` k_d [s]. The derivative's `filter` f [Hz] limits the gain at
    high frequencies to k_p + 2 pi f k_d. `tracking` is defined as for `PI`. Raises `DesignError` for negative gains and a derivative
    without a filter.

    >>> control = PID(proportional=0.5, integral=100.0, derivative=0.01, filter=1000.0)
    >>> found = control.system().transfer(np.array([10.0]))[0, 0, 0]
    >>> omega = 2.0 * np.pi * 10.0
    >>> bool(np.isclose(found, 0.5 + 100.0 / (1j * omega) + 0.01j * omega / (1.0 + 0.01j)))
    True
    """

    proportional: Annotated[float, FIVE_DIGITS]
    integral: Annotated[float, RATE, FIVE_DIGITS]
    derivative: Annotated[float, SHORT_TIME, FIVE_DIGITS]
    filter: Annotated[float, FREQUENCY, FIVE_DIGITS]
    tracking: Annotated[float | None, TIME] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        gains = {"proportional": (self.proportional, ""), "integral": (self.integral, " 1/s"), "derivative": (self.derivative, " s")}
        found = list(gain_findings("PID", gains))
        if not 0.0 < self.filter < np.inf:
            what = f"derivative filter without a positive corner (got {self.filter:g} Hz)"
            found.append(Finding("PID", what, "Use a positive corner, for example ten times the bandwidth"))
        require([*found, *tracking_findings("PID", self.tracking)])

    @property
    def tracking_time(self) -> float:
        """Anti-windup tracking time T_t [s], as for `PI`."""
        return PI(self.proportional, self.integral, self.tracking).tracking_time

    def system(self, step: float | None = None) -> System:
        """Return the linear system (see `Law`), discretised by Tustin's rule.

        Raises `DesignError` if `filter` is not below half the sampling rate, and for a tracking time below one sample.
        """
        require(slow_tracking_findings("PID", self.tracking, step))
        require(corner_findings("PID", "the filter corner at", self.filter, step, ", or lower the corner") if self.derivative else ())
        corner = 2.0 * np.pi * self.filter
        high = self.derivative * corner
        A, B = np.diag([0.0, -corner]), np.array([[self.integral, 0.0, tracking_rate(self.tracking_time, step)], [corner, 0.0, 0.0]])
        C, D = np.array([[1.0, -high]]), np.array([[self.proportional + high, 0.0, 0.0]])
        return law_system(A, B, C, D, step, kept=[self.integral > 0.0, self.derivative > 0.0])
