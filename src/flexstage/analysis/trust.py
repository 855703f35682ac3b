"""Outcome of a comparison of theory and FEA, in a separate module so that tables need not import the comparison."""

from __future__ import annotations

from enum import Enum


class TheoryCheck(Enum):
    """Outcome of a comparison of theory and FEA."""

    DEPENDENT = "not independent"
    EITHER = "they agree"
    UNCLEAR = "FEA mesh too coarse"
    THEORY = "theory suffices"
    CALIBRATED = "calibrated theory"
    FEA = "FEA"
