"""Which of several results a comparison speaks for. Light: tables name it without loading what is compared."""

from __future__ import annotations

from enum import Enum


class Trust(Enum):
    """Which result a comparison speaks for."""

    DEPENDENT = "not independent"
    EITHER = "they agree"
    UNCLEAR = "FEA too coarse to tell"
    THEORY = "theory will do"
    CALIBRATED = "calibrated theory"
    FEA = "FEA"
