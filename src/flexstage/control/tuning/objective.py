"""Objectives of optimisation-based tuning. Light: the command line names the choices without loading more."""

from __future__ import annotations

from enum import Enum

SENSITIVITY = 2.0
"""Highest peak of S where none is stated: 6 dB."""


class TuningObjective(Enum):
    """Objective of optimisation-based tuning, within the required margins."""

    BALANCE = "balance"
    """Rejection and settling together, and with what is left of freedom noise."""
    REJECTION = "rejection"
    """Disturbances are made smaller up to the highest frequency."""
    NOISE = "noise"
    """The least motion at rest, of what the floor and the gauges do."""
    SETTLING = "settling"
    """The shortest time until steps stay within 2 %."""
