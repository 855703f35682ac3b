"""Objectives of optimisation-based tuning. A light module: the command line lists the choices without further imports."""

from __future__ import annotations

from enum import Enum

SENSITIVITY = 2.0
"""Default limit of the peak of S: 6 dB."""


class TuningObjective(Enum):
    """Objective of optimisation-based tuning; the required margins are constraints."""

    BALANCE = "balance"
    """High sensitivity crossover and short settling time together, then low noise."""
    REJECTION = "rejection"
    """Highest sensitivity crossover."""
    NOISE = "noise"
    """Lowest positioning noise due to floor and gauges."""
    SETTLING = "settling"
    """Shortest 2 % settling time of steps."""
