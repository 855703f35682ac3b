"""Sampling clock of a record: the rate from times or printed steps, and gaps between samples."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.number import Array
from flexstage.experiment.records.options import FaultTolerance, Options, assign, select_names
from flexstage.experiment.records.record import RATES, Channel, Record, Samples

_LISTED = 5
_BLOCK = 262_144
TIME_SCALES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
"""Seconds per unit of time."""


def round_nominal(value: float, uncertainty: float) -> float:
    """Round a value within its uncertainty to the number that has the fewest digits, or whose inverse has the fewest digits.

    `uncertainty` is the relative uncertainty of the value.

    A step printed as 4.88281e-04 s means 2048 Hz, not 2048.002.

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
    """Compute the relative uncertainty of a printed number: half a unit of its last digit, divided by the number.

    >>> printed_uncertainty("5.0e-04"), printed_uncertainty("0.25")
    (0.01, 0.02)
    """
    mantissa = re.split("[ed]", text.strip().lower())[0]
    decimals = len(mantissa.partition(".")[2])
    value = abs(float(mantissa))
    return 0.0 if value == 0.0 else round(0.5 * 10.0**-decimals / value, 15)


@dataclass(frozen=True)
class Clock:
    """Sampling clock: rate [Hz], time of the first sample [s], intervals without gaps: sample numbers (start, stop), start times [s].

    Without a list of intervals there is no gap.
    """

    rate: float
    start: float = 0.0
    stretches: tuple[tuple[int, int], ...] = ()
    starts: tuple[float, ...] = ()

    @property
    def longest(self) -> tuple[int, int]:
        """Longest interval (start, stop) of samples without a gap."""
        return max(self.stretches, key=lambda stretch: stretch[1] - stretch[0])


def read_clock(times: Array, where: str) -> Clock:
    """Determine the sampling clock from times (n,) in s; raises `DesignError` for too few, non-finite, repeated or uneven times.

    A time step is a gap if it differs from the median step by more than half the median step. The rate is computed from the steps that are
    not gaps, and rounded within the precision of the times.

    >>> read_clock(np.array([0.0, 0.1, 0.2, 0.7, 0.8]), "a.csv").stretches
    ((0, 3), (3, 5))
    """
    steps = np.diff(times)
    typical = float(np.median(steps)) if len(steps) else 0.0
    regular = np.abs(steps - typical) <= 0.5 * abs(typical)
    jumps = 1 + np.flatnonzero(~regular)
    require(_problems(times, typical, len(jumps), where))
    total, spread = float(np.sum(steps[regular])), float(np.max(np.abs(steps[regular] - typical)))
    resolution = max(float(np.spacing(np.max(np.abs(times)))), spread)  # double precision; coarser rounding appears in the scatter
    rate = round_nominal(int(np.count_nonzero(regular)) / total, max(resolution / total, 1e-12))
    starts = [0, *jumps.tolist()]
    return Clock(rate, float(times[0]), tuple(pairwise([*starts, len(times)])), tuple(times[starts].tolist()))


def determine_clock(samples: Samples, options: Options, where: str, *, scale: float = 1.0, stated: float | None = None) -> Clock:
    """Determine the sampling clock from the first column of samples, which contains the times in units of `scale` [s].

    A rate `stated` in the file [Hz] replaces the rate that follows from the times; both rates must agree within a thousandth. Raises
    `DesignError` for faulty times.

    >>> from flexstage.experiment.records.record import InMemory
    >>> times = InMemory(np.array([[0.0], [0.1], [0.2], [0.7], [0.8]]))
    >>> determine_clock(times, Options(accept_faults=frozenset({FaultTolerance.GAPS})), "a.csv").longest
    (0, 3)
    >>> determine_clock(times, Options(), "a.csv")
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: a.csv: there is 1 gap between samples, before 0.7 s. The longest stretch without gaps has 3 ...
    """
    blocks = [samples.read(start, min(start + _BLOCK, samples.length))[:, 0] * scale for start in range(0, samples.length, _BLOCK)]
    clock = read_clock(np.concatenate([np.zeros(0), *blocks]), where)
    if len(clock.stretches) > 1 and FaultTolerance.GAPS not in options.accept_faults:
        raise _gaps(clock, where)
    if stated is not None and abs(stated / clock.rate - 1.0) > 1e-3:
        raise refuse(
            where,
            f"contradictory rates: {clock.rate:g} Hz from the times, {stated:g} Hz stated in the file",
            "Specify the correct rate (option rate)",
        )
    return replace(clock, rate=stated or clock.rate)


def clocked_record(channels: Iterable[Channel], samples: Samples, clock: Clock, options: Options, *, name: str, where: str) -> Record:
    """Build a record of the selected channels over the clock's longest interval without gaps.

    >>> from flexstage.experiment.records.record import Channel, InMemory
    >>> clock = Clock(1.0, 0.0, ((0, 1), (1, 3)), (0.0, 7.0))
    >>> found = clocked_record([Channel("a")], InMemory(np.array([[1.0], [2.0], [3.0]])), clock, Options(), name="", where="a.csv")
    >>> found.start, found.values[:, 0].tolist()
    (7.0, [2.0, 3.0])
    """
    whole = Record(assign(channels, options, where), clock.rate, samples, clock.start, name=name, source=where)
    return longest_stretch(whole.select(select_names(whole.names, options)) if options.only else whole, clock)


def longest_stretch(record: Record, clock: Clock) -> Record:
    """Return the longest interval of a record without gaps, with the interval's start time; a record without gaps is unchanged."""
    if len(clock.stretches) < 2:
        return record
    return replace(record.part(*clock.longest), start=clock.starts[clock.stretches.index(clock.longest)])


def _gaps(clock: Clock, where: str) -> DesignError:
    gaps = len(clock.stretches) - 1
    listed = ", ".join(f"{time:.6g} s" for time in clock.starts[1 : 1 + _LISTED])
    start, stop = clock.longest
    what = (
        f"there {'is 1 gap' if gaps == 1 else f'are {gaps} gaps'} between samples, before {listed}{' and more' if gaps > _LISTED else ''}"
    )
    length = f"{stop - start} samples ({(stop - start) / clock.rate:.4g} s)"
    return refuse(where, what, f'The longest stretch without gaps has {length}: accept "gaps" to use only this stretch')


def _problems(times: Array, typical: float, jumps: int, where: str) -> Iterator[Finding]:
    """First fault of times as a clock."""
    count, broken = len(times), int(np.count_nonzero(~np.isfinite(times)))
    if count < 2:
        yield Finding(where, f"too few samples (got {count})", "Use a record of at least two samples")
    elif broken:
        yield Finding(where, f"{broken} of {count} times are not numbers", "Correct the times, or specify the rate")
    elif not typical > 0.0:
        what = f"its times do not increase: the median step is {typical:.4g} s, from {times[0]:.6g} s to {times[-1]:.6g} s"
        yield Finding(where, what, "Write times with more digits, or specify the rate")
    elif not RATES[0] <= 1.0 / typical <= RATES[1]:
        yield Finding(where, f"invalid median time step (got {typical:.4g} s)", "Write times in s, or specify the rate")
    elif jumps > min(count - 2, max(2, 0.01 * count)):
        what = f"its samples are not evenly spaced: {jumps} of {count - 1} steps differ by more than 50 % from the median, {typical:.4g} s"
        yield Finding(where, what, "Resample the record evenly, or specify the rate if only the times are wrong")
