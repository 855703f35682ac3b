"""Proportional and integral control."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, require
from flexstage.base.units.quantity import RATE, TIME
from flexstage.control.controllers.law import FIVE_DIGITS, gain_findings, law_system, slow_tracking_findings, tracking_rate
from flexstage.control.systems.system import System


@dataclass(frozen=True)
class PI(CheckedFields):
    """PI controller k_p + k_i / s from a loop's error e [m] to its command [m]: `proportional` k_p [1], `integral` k_i [1/s].

    Under saturation the integrator's state x follows the applied input with the time constant `tracking` T_t [s]: x' = k_i e + (applied -
    commanded)/T_t. This is back-calculation (Astrom and Haegglund, Advanced PID Control, 2006, section 3.5). The default of `tracking` is
    (1 + k_p)/k_i, the time constant of the loop with a plant of gain 1, but at least one sample. Raises `DesignError` for negative gains.

    >>> control = PI(proportional=0.5, integral=100.0)
    >>> control.tracking_time, control.system().transfer(np.array([100.0 / (2.0 * np.pi)]))[0, 0, 0].round(12)  # 0.5 + 100/(100j)
    (0.015, np.complex128(0.5-1j))
    """

    proportional: Annotated[float, FIVE_DIGITS] = 0.0
    integral: Annotated[float, RATE, FIVE_DIGITS] = 0.0
    tracking: Annotated[float | None, TIME] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        gains = {"proportional": (self.proportional, ""), "integral": (self.integral, " 1/s")}
        require([*gain_findings("PI", gains), *tracking_findings("PI", self.tracking)])

    @property
    def tracking_time(self) -> float:
        """Tracking time T_t [s]; infinite without an integral part."""
        if self.tracking is not None:
            return self.tracking
        return (1.0 + self.proportional) / self.integral if self.integral else np.inf

    def system(self, step: float | None = None) -> System:
        """Return the linear system (see `Law`), discretised by Tustin's rule. Raises `DesignError` for a tracking time below one sample."""
        require(slow_tracking_findings("PI", self.tracking, step))
        direct = np.array([[self.proportional, 0.0, 0.0]])
        entry = np.array([[self.integral, 0.0, tracking_rate(self.tracking_time, step)]])
        return law_system(np.zeros((1, 1)), entry, np.eye(1), direct, step, kept=[self.integral > 0.0])


def tracking_findings(kind: str, tracking: float | None) -> list[Finding]:
    """Return a finding if a tracking time [s] is not positive.

    >>> [each.what for each in tracking_findings("PI", 0.0)]
    ['tracking time must be positive (got 0 s)']
    """
    if tracking is None or tracking > 0.0:
        return []
    return [Finding(kind, f"tracking time must be positive (got {tracking:g} s)", "Use a positive time, or omit the tracking time")]
