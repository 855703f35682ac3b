"""The clock of a record: the sampling rate that times or printed steps mean, and gaps between samples."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from flexstage.base.finding import DesignError, Finding, refuse
from flexstage.base.number import Array
from flexstage.experiment.records.record import RATES, Record

_LISTED = 5
TIME_SCALES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
"""Seconds in the units that times may have."""


def round_nominal(value: float, uncertainty: float) -> float:
    """The roundest number a rounded value can have meant: it or its inverse has the fewest digits within the relative uncertainty.

    A step printed as 4.88281e-04 s stands for 2048 Hz, not for 2048.002.

    >>> round_nominal(1 / 4.88281e-04, 1e-6), round_nominal(1 / 0.333, 1e-3), round_nominal(1 / 0.195313, 3e-6), round_nominal(3.14159, 0.0)
    (2048.0, 3.0, 5.12, 3.14159)
    """
    if not RATES[0] <= abs(value) <= RATES[1]:
        return value
    bound = uncertainty * abs(value)
    for digits in range(1, 16):
        for candidate in (float(f"{value:.{digits}g}"), 1.0 / float(f"{1.0 / value:.{digits}g}")):
            if abs(candidate - value) <= bound:
                return candidate
    return value


def printed_uncertainty(text: str) -> float:
    """Relative uncertainty of a printed number: half a unit of its last digit.

    >>> printed_uncertainty("5.0e-04"), printed_uncertainty("0.25")
    (0.01, 0.02)
    """
    mantissa = re.split("[ed]", text.strip().lower())[0]
    decimals = len(mantissa.partition(".")[2])
    value = abs(float(mantissa))
    return 0.0 if value == 0.0 else round(0.5 * 10.0**-decimals / value, 15)


@dataclass(frozen=True)
class Clock:
    """What times say: the rate in Hz, the first time in s, stretches (start, stop) of samples without a gap, the times they start at."""

    rate: float
    start: float
    stretches: tuple[tuple[int, int], ...]
    starts: tuple[float, ...] = ()

    @property
    def longest(self) -> tuple[int, int]:
        """The longest stretch without a gap."""
        return max(self.stretches, key=lambda stretch: stretch[1] - stretch[0])


@dataclass
class _Steps:
    """What is known of the steps so far, block by block."""

    typical: float = 0.0
    first: float = 0.0
    last: float = 0.0
    count: int = 0
    spread: float = 0.0
    jumps: list[tuple[int, float, float]] = field(default_factory=list[tuple[int, float, float]])
    regular: float = 0.0
    steps: int = 0
    resolution: float = 0.0
    broken: int = 0


def read_clock(times: Iterable[Array], where: str) -> Clock | list[Finding]:
    """The clock of times in s, given in blocks; or the findings that keep it from being one: too few, none, repeated, not evenly spaced.

    Times may be rounded: single steps may differ by a quarter from the usual one, and the rate is that of all of them. A step of more than
    one and a half is a gap and divides the record in stretches. Times that were printed with few digits
    give the roundest rate they allow.

    >>> read_clock([np.array([0.0, 0.1, 0.2]), np.array([0.3])], "a.csv")
    Clock(rate=10.0, start=0.0, stretches=((0, 4),), starts=(0.0,))
    >>> read_clock([np.array([0.0, 0.1, 0.2, 0.7, 0.8])], "a.csv").stretches
    ((0, 3), (3, 5))
    """
    known = _Steps()
    for block in times:
        _update(known, np.asarray(block, dtype=float))
    found = _problem(known, where)
    if found is not None:
        return [found]
    mean = known.regular / known.steps
    uncertainty = max(known.resolution / known.regular, 1e-12)
    starts = (known.first, *(after for _, _, after in known.jumps))
    edges = [0, *(index for index, _, _ in known.jumps), known.count]
    return Clock(round_nominal(1.0 / mean, uncertainty), known.first, tuple(pairwise(edges)), starts)


@dataclass(frozen=True)
class StatedClock:
    """What is told of times beside them: the rate the file states, if any, and whether gaps may be passed over."""

    rate: float | None = None
    allow_gaps: bool = False


def determine_clock(times: Iterable[Array], at: Callable[[int], float], told: StatedClock, where: str) -> Clock:
    """The clock of times in s, given in blocks and, for the message of gaps, one by one; raises `DesignError` with what is wrong with it.

    A rate that the file states beside the times holds where they agree within a thousandth.

    >>> times = np.array([0.0, 0.1, 0.2, 0.7, 0.8])
    >>> determine_clock([times], lambda number: float(times[number]), StatedClock(allow_gaps=True), "a.csv").longest
    (0, 3)
    >>> determine_clock([times], lambda number: float(times[number]), StatedClock(), "a.csv")
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: a.csv: there is 1 gap between samples, before 0.7 s. The longest stretch without gaps has 3 ...
    """
    clock = read_clock(times, where)
    if isinstance(clock, list):
        raise DesignError(clock)
    if len(clock.stretches) > 1 and not told.allow_gaps:
        raise DesignError([_gaps(clock, [at(start) for start, _ in clock.stretches[1 : 1 + _LISTED]], where)])
    if told.rate is not None and abs(told.rate / clock.rate - 1.0) > 1e-3:
        raise refuse(
            where, f"its times say {clock.rate:g} Hz, the file also states {told.rate:g} Hz", "State the rate that is right (rate)"
        )
    return replace(clock, rate=told.rate or clock.rate)


def longest_stretch(record: Record, clock: Clock) -> Record:
    """The longest stretch of a record without gaps, with the time it starts at; the record where there are none.

    >>> from flexstage.experiment.records.record import Channel, in_memory
    >>> gap = Clock(1.0, 0.0, ((0, 1), (1, 3)), (0.0, 7.0))
    >>> found = longest_stretch(in_memory([Channel("a")], 1.0, np.array([[1.0], [2.0], [3.0]])), gap)
    >>> found.start, found.values[:, 0].tolist()
    (7.0, [2.0, 3.0])
    """
    if len(clock.stretches) < 2:
        return record
    longest = clock.longest
    return replace(record.part(*longest), start=clock.starts[clock.stretches.index(longest)])


def _gaps(clock: Clock, times: list[float], where: str) -> Finding:
    gaps = len(clock.stretches) - 1
    listed = ", ".join(f"{time:.6g} s" for time in times)
    start, stop = clock.longest
    what = (
        f"there {'is 1 gap' if gaps == 1 else f'are {gaps} gaps'} between samples, before {listed}{' and more' if gaps > _LISTED else ''}"
    )
    length = f"{stop - start} samples ({(stop - start) / clock.rate:.4g} s)"
    return Finding(where, what, f'The longest stretch without gaps has {length}: accept "gaps" to use it alone')


def _update(known: _Steps, block: Array) -> None:
    if block.size == 0:
        return
    known.broken += int(np.count_nonzero(~np.isfinite(block)))
    whole = block if known.count == 0 else np.concatenate([[known.last], block])
    steps = np.diff(whole)
    if known.count == 0:
        known.first = float(block[0])
    if known.typical == 0.0 and steps.size:
        known.typical = float(np.median(steps))
    regular = np.abs(steps - known.typical) <= 0.5 * abs(known.typical)
    offset = known.count - (len(whole) - len(block))
    known.jumps += [(offset + int(index) + 1, float(whole[index]), float(whole[index + 1])) for index in np.flatnonzero(~regular)[:100_000]]
    known.regular += float(np.sum(steps[regular]))
    known.steps += int(np.count_nonzero(regular))
    if regular.any():
        known.spread = max(known.spread, float(np.max(np.abs(steps[regular] - known.typical))))
    known.resolution = max(known.resolution, _resolution(block), known.spread)
    known.last, known.count = float(block[-1]), known.count + len(block)


def _resolution(block: Array) -> float:
    """Rounding of times in double precision; coarser rounding shows in the spread of the steps."""
    return float(np.spacing(np.nanmax(np.abs(block)))) if np.isfinite(block).any() else 0.0


def _problem(known: _Steps, where: str) -> Finding | None:
    if known.count < 2:
        return Finding(where, f"it has {known.count} samples", "Give a record of at least two samples")
    if known.broken:
        return Finding(where, f"{known.broken} of {known.count} times are not numbers", "Mend them, or state the rate")
    if not known.typical > 0.0:
        what = f"its times do not rise: the usual step is {known.typical:.4g} s, from {known.first:.6g} s to {known.last:.6g} s"
        return Finding(where, what, "Write times with enough digits to tell samples apart, or state the rate")
    if not RATES[0] <= 1.0 / known.typical <= RATES[1]:
        return Finding(where, f"its usual step is {known.typical:.4g} s, which is none", "Write times in s, or state the rate")
    if len(known.jumps) > max(2, 0.01 * known.count):
        share = f"{len(known.jumps)} of {known.count} steps"
        what = f"its samples are not evenly spaced: {share} differ by more than half from {known.typical:.4g} s"
        return Finding(where, what, "Resample the record evenly, or state the rate if only the times are wrong")
    return None
