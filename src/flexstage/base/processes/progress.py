"""Progress of any long computation: where it stands, and how long it takes still."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

_MINUTES, _HOURS = 90.0, 2.0 * 3600.0
"""From so many seconds on a time is told in minutes, in hours."""

LINES, LINE = "FLEXSTAGE_PROGRESS", "progress"
"""Variable of the environment by which a program asks a command for lines, and the word that each of them begins with."""


@dataclass(frozen=True)
class Step:
    """State of a computation: what is being done, the fraction that is done, and the seconds left (`None`: too early to say)."""

    text: str
    fraction: float
    left: float | None


Progress = Callable[[Step], None]
"""Told of every step, in the process and thread that called the computation; raising there stops it and cleans up."""


def duration(seconds: float) -> str:
    """A time that is known roughly, in words.

    >>> duration(0.2), duration(40.0), duration(90.0), duration(9000.0)
    ('1 s', '40 s', '2 minutes', '2.5 hours')
    """
    if seconds >= _HOURS:
        return f"{seconds / 3600.0:.1f} hours"
    return f"{seconds / 60.0:.0f} minutes" if seconds >= _MINUTES else f"{max(seconds, 1.0):.0f} s"


def seconds_left(fraction: float, elapsed: float) -> float | None:
    """Time left if it goes on as it went, absent while too little is done to tell.

    >>> seconds_left(0.25, 10.0), seconds_left(0.01, 10.0)
    (30.0, None)
    """
    return None if fraction < 0.05 else elapsed * (1.0 - fraction) / fraction
