"""Progress of any long computation: where it stands, and how long it takes still."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

LINES, LINE = "FLEXSTAGE_PROGRESS", "progress"
"""Variable of the environment by which a program asks a command for lines, and the word that each of them begins with."""


@dataclass(frozen=True)
class Step:
    """Where the whole stands: what is done now, the fraction that is done, and the seconds left as far as can be told."""

    text: str
    fraction: float
    left: float | None


Progress = Callable[[Step], None]
"""Told of every step, in the process and thread that called the computation; raising there stops it and cleans up."""


def seconds_left(fraction: float, elapsed: float) -> float | None:
    """Time left if it goes on as it went, absent while too little is done to tell.

    >>> seconds_left(0.25, 10.0), seconds_left(0.01, 10.0)
    (30.0, None)
    """
    return None if fraction < 0.05 else elapsed * (1.0 - fraction) / fraction
