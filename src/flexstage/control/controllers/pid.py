"""Proportional, integral and filtered derivative control."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, require
from flexstage.base.units.quantity import FREQUENCY, RATE, SHORT_TIME, TIME
from flexstage.control.controllers.law import FIVE_DIGITS, gain_findings, law_system, slow_tracking_findings, tracking_rate
from flexstage.control.controllers.pi import PI, tracking_findings
from flexstage.control.systems.system import System


@dataclass(frozen=True)
class PID(CheckedFields):
    """C(s) = k_p + k_i / s + k_d s / (1 + s / (2 pi f)): `proportional` [1], `integral` [1/s], `derivative` [s], `filter` f [Hz].

    From a loop's error [m] to its command [m]. The derivative acts on the error; its filter bounds the gain at high frequencies by k_p + 2
    pi f k_d. `tracking` as for `PI`. Raises `DesignError` for negative gains and a derivative without a filter.

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
        """Refuse gains that cannot be."""
        found = list(gain_findings("PID", {"proportional": self.proportional}))
        found += gain_findings("PID", {"integral": self.integral}, "1/s")
        found += gain_findings("PID", {"derivative": self.derivative}, "s")
        if not 0.0 < self.filter < np.inf:
            what = f"the derivative's filter is at {self.filter:g} Hz"
            found.append(Finding("PID", what, "Give a positive corner, for example ten times the bandwidth"))
        require([*found, *tracking_findings("PID", self.tracking)])

    @property
    def tracking_time(self) -> float:
        """T_t [s], as for `PI`."""
        return PI(self.proportional, self.integral, self.tracking).tracking_time

    def system(self, step: float | None = None) -> System:
        """The law, as `Law` says; Tustin's rule with a step. Raises `DesignError` for a filter above half the sampling rate."""
        require([*slow_tracking_findings("PID", self.tracking, step), *self._sampling(step)])
        corner = 2.0 * np.pi * self.filter
        high = self.derivative * corner
        A, B = np.diag([0.0, -corner]), np.array([[self.integral, 0.0, tracking_rate(self.tracking_time, step)], [corner, 0.0, 0.0]])
        C, D = np.array([[1.0, -high]]), np.array([[self.proportional + high, 0.0, 0.0]])
        kept = [number for number, used in enumerate((self.integral, self.derivative)) if used]
        return law_system(A[np.ix_(kept, kept)], B[kept], C[:, kept], D, step)

    def _sampling(self, step: float | None) -> list[Finding]:
        if step is None or not self.derivative or self.filter < 0.5 / step:
            return []
        what = f"the derivative's filter at {self.filter:g} Hz is not below half the sampling rate, {0.5 / step:g} Hz"
        return [Finding("PID", what, f"Sample above {2.0 * self.filter:g} Hz, or lower the filter")]
