"""Progress of long computations: completed fraction and remaining time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

_MINUTES, _HOURS = 90.0, 2.0 * 3600.0
"""Times [s] from which minutes and hours are used."""

LINES, LINE = "FLEXSTAGE_PROGRESS", "progress"
"""`LINES`: environment variable that enables progress lines of a command. `LINE`: prefix of each progress line."""
RESULT = "result"
"""Prefix of a line with one named part of the result as JSON. Such lines are printed only with progress lines."""


@dataclass(frozen=True)
class Step:
    """State of a computation: activity, completed fraction, and remaining seconds (`None`: not yet known)."""

    text: str
    fraction: float
    left: float | None


Progress = Callable[[Step], None]
"""Callback for every step, called in the caller's process and thread. An exception in the callback stops the computation and cleans up."""


def duration(seconds: float) -> str:
    """Return an approximate time as a string.

    >>> duration(0.2), duration(40.0), duration(90.0), duration(9000.0)
    ('1 s', '40 s', '2 minutes', '2.5 hours')
    """
    if seconds >= _HOURS:
        return f"{seconds / 3600.0:.1f} hours"
    return f"{seconds / 60.0:.0f} minutes" if seconds >= _MINUTES else f"{max(seconds, 1.0):.0f} s"


def seconds_left(fraction: float, elapsed: float) -> float | None:
    """Return the remaining time [s], extrapolated from completed fraction and elapsed time; `None` if it is too early for an estimate.

    >>> seconds_left(0.25, 10.0), seconds_left(0.01, 10.0)
    (30.0, None)
    """
    return None if fraction < 0.05 else elapsed * (1.0 - fraction) / fraction
