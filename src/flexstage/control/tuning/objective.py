"""Objectives of optimisation-based tuning. A light module: the command line lists the choices without further imports."""

from __future__ import annotations

from enum import Enum

SENSITIVITY = 2.0
"""Default limit of the peak of S: 6 dB."""


class TuningObjective(Enum):
    """Objective of optimisation-based tuning, within the required margins."""

    BALANCE = "balance"
    """Rejection and settling together, and low noise with the remaining freedom."""
    REJECTION = "rejection"
    """Highest sensitivity crossover."""
    NOISE = "noise"
    """Lowest positioning noise by floor and gauges."""
    SETTLING = "settling"
    """Shortest 2 % settling time of steps."""
