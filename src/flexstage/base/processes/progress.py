"""Progress of any long computation: where it stands, and how long it takes still."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from heapq import heappop, heappush
from types import MappingProxyType

_NOTHING: Mapping[str, float] = MappingProxyType({})
_PRIOR = 0.5
"""Seconds for which the usual pace counts beside what was measured."""
_TAIL = 0.1
"""Share of its usual time that a job is taken to need still when it has had all of it."""
_MINUTES, _HOURS = 90.0, 2.0 * 3600.0
"""From so many seconds on a time is told in minutes, in hours."""

LINES, LINE = "FLEXSTAGE_PROGRESS", "progress"
"""Variable of the environment by which a program asks a command for lines, and the word that each of them begins with."""


@dataclass(frozen=True)
class Step:
    """Where the whole stands: what is done now, the fraction that is done, and the seconds left as far as can be told.

    Of jobs by key: the seconds `spent` on those that are done, those that the `running` ones have had, and what each is `planned` to take.
    """

    text: str
    fraction: float
    left: float | None
    spent: Mapping[str, float] = field(default_factory=dict[str, float])
    running: Mapping[str, float] = field(default_factory=dict[str, float])
    planned: Mapping[str, float] = field(default_factory=dict[str, float])


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


def time_left(
    phases: Iterable[Mapping[str, float]], spent: Mapping[str, float], running: Mapping[str, float] = _NOTHING, lanes: int = 1
) -> float:
    """Seconds left of jobs in phases, so many at once, from what each is planned to take and what those took that are done.

    What was spent over what was planned for it is the pace of this machine, by which the plan of the others is multiplied; a running job
    that takes longer than that counts as done. A phase begins when the one before is over.

    >>> time_left([{"a": 10.0, "b": 10.0}, {"c": 30.0}], {})
    50.0
    >>> round(time_left([{"a": 10.0, "b": 10.0}, {"c": 30.0}], {"a": 22.0}))  # a slow machine
    86
    """
    phases = tuple(phases)
    planned = {name: seconds for phase in phases for name, seconds in phase.items()}
    rate = pace(planned, spent, running)
    total = 0.0
    for phase in phases:
        rest = {name: rate * seconds for name, seconds in phase.items() if name not in spent}
        begun = [max(rest[name] - running[name], _TAIL * rest[name]) for name in rest if name in running]
        total += _span([*begun, *(seconds for name, seconds in rest.items() if name not in running)], lanes)
    return total


def pace(planned: Mapping[str, float], spent: Mapping[str, float], running: Mapping[str, float] = _NOTHING) -> float:
    """How much longer jobs take than planned.

    >>> pace({"a": 99.5, "b": 5.0}, {"a": 199.5})
    2.0
    """
    known = {name: seconds for name, seconds in spent.items() if name in planned}
    late = {name: seconds for name, seconds in running.items() if name in planned and name not in known}
    rate = (_PRIOR + sum(known.values())) / (_PRIOR + sum(planned[name] for name in known))
    known |= {name: seconds for name, seconds in late.items() if seconds > rate * planned[name]}
    return (_PRIOR + sum(known.values())) / (_PRIOR + sum(planned[name] for name in known))


def _span(seconds: Iterable[float], lanes: int) -> float:
    """How long jobs take together, each given to whoever is free first."""
    ends: list[float] = []
    for each in seconds:
        heappush(ends, each + (heappop(ends) if len(ends) >= lanes else 0.0))
    return max(ends, default=0.0)
