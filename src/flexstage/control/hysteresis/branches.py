"""Branches of a record between voltage reversals, and checks of a record of voltage and stroke."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array

MAJOR = 0.8
"""Branches that span at least this fraction of the voltage range belong to major loops."""
_LEAST = 0.1
_BINS = 20
_FEWEST = 40
_FEWEST_A_BRANCH = 10
_FALL = 0.02
_AHEAD = 0.01
_LARGEST_STROKE = 0.01


@dataclass(frozen=True)
class Branch:
    """Ascending or descending branch: samples `start` to `stop` (both ends included), from voltage `first` to `last`."""

    start: int
    stop: int
    first: float
    last: float

    @property
    def rises(self) -> bool:
        """Whether the voltage rises."""
        return self.last > self.first

    @property
    def swing(self) -> float:
        """Voltage span in V."""
        return abs(self.last - self.first)


def branches_of(volts: Array, least: float = _LEAST) -> list[Branch]:
    """Split a record (k,) at its turning points into branches; reversals smaller than the fraction `least` of the range count as noise.

    >>> [(each.first, each.last) for each in branches_of(np.array([0.0, 5.0, 10.0, 9.9, 10.0, 4.0, 0.0, 8.0]))]
    [(0.0, 10.0), (10.0, 0.0), (0.0, 8.0)]
    """
    threshold = least * np.ptp(volts)
    turns, low, high, going = [0], 0, 0, 0
    for place in _extremes(volts):
        value = volts[place]
        high = place if value > volts[high] else high
        low = place if value < volts[low] else low
        if going <= 0 and value - volts[low] >= threshold:
            turns += [low] if low > turns[-1] else []
            going, high = 1, place
        elif going >= 0 and volts[high] - value >= threshold:
            turns += [high] if high > turns[-1] else []
            going, low = -1, place
    last = high if going > 0 else low
    turns += [last] if last > turns[-1] else []
    return [Branch(start, stop, float(volts[start]), float(volts[stop])) for start, stop in pairwise(turns)]


def _extremes(volts: Array) -> list[int]:
    """Samples of all voltage reversals, however small, and both ends."""
    steps = np.diff(volts)
    moves = np.flatnonzero(steps)
    ways = np.sign(steps[moves])
    return [0, *moves[1:][ways[1:] != ways[:-1]].tolist(), len(volts) - 1]


def record_findings(volts: Array, strokes: Array) -> list[Finding]:
    """Check that a record (k,) of a stack's voltage [V] and stroke [m] shows hysteresis. Returns the findings of the first failed check.

    >>> record_findings(np.arange(100.0), 1e-7 * np.arange(100.0))[0].what
    'the voltage changes from 0 V to 99 V without reversal: the record cannot show hysteresis'
    """
    checks = (_channel_findings, _column_findings, _branch_findings, _loop_findings)
    return next((found for check in checks if (found := [*check(volts, strokes)])), [])


def _channel_findings(volts: Array, strokes: Array) -> Iterator[Finding]:
    if volts.ndim != 1 or volts.shape != strokes.shape:
        yield Finding(
            "record",
            f"different lengths (got volts {volts.shape}, strokes {strokes.shape})",
            "Use one voltage and one stroke for every sample",
        )
        return
    if len(volts) < _FEWEST:
        yield Finding("record", f"too few samples (got {len(volts)}, expected at least {_FEWEST})", "Record more samples")
    for name, values in (("volts", volts), ("stroke", strokes)):
        if not np.all(np.isfinite(values)):
            place = np.argmin(np.isfinite(values))
            yield Finding(name, f"sample {place} is {values[place]}", "Truncate the record before this sample, or correct the channel")
        elif np.ptp(values) <= 1e-9 * np.max(np.abs(values)):
            yield Finding(
                name,
                f"all samples equal {values[0]:g}: the channel has no signal",
                "Check the cable and range of this channel, or select another channel",
            )


def _column_findings(volts: Array, strokes: Array) -> Iterator[Finding]:
    if np.ptp(strokes) > _LARGEST_STROKE:
        what = f"the stroke changes by {np.ptp(strokes):g} m, the voltage by {np.ptp(volts):g} V"
        yield Finding("record", what, "Check the units of both channels, and whether they are exchanged")


def _branch_findings(volts: Array, _: Array) -> Iterator[Finding]:
    branches = branches_of(volts)
    if len(branches) < 2:
        what = f"the voltage changes from {volts[0]:g} V to {volts[-1]:g} V without reversal: the record cannot show hysteresis"
        yield Finding("volts", what, "Record two cycles over the whole range, then smaller inner loops")
        return
    counts = np.array([branch.stop - branch.start + 1 for branch in branches])
    if np.any(counts < _FEWEST_A_BRANCH):
        worst = np.argmin(counts)
        what = f"{np.sum(counts < _FEWEST_A_BRANCH)} of {len(branches)} branches have fewer than {_FEWEST_A_BRANCH} samples"
        which = f"branch {worst + 1} from {branches[worst].first:g} V to {branches[worst].last:g} V has {counts[worst]}"
        yield Finding("volts", f"{what}: {which}", "Record more slowly, or sample faster")
    major = [branch for branch in branches[1:] if branch.swing >= MAJOR * np.ptp(volts)]
    for rises, word in ((True, "rising"), (False, "falling")):
        if not any(branch.rises == rises for branch in major):
            what = f"no {word} branch after the first covers at least {MAJOR:.0%} of the range, {np.min(volts):g} V to {np.max(volts):g} V"
            yield Finding("volts", what, "Record at least 1.5 cycles over the whole range: the first branch depends on the history")


def _loop_findings(volts: Array, strokes: Array) -> Iterator[Finding]:
    major = [branch for branch in branches_of(volts)[1:] if branch.swing >= MAJOR * np.ptp(volts)]
    size = np.ptp(strokes)
    means = [_bin(volts, strokes, branch) for branch in major]
    risen = np.mean([np.sign(branch.last - branch.first) * (strokes[branch.stop] - strokes[branch.start]) for branch in major])
    if risen < 0.0:
        what = f"the stroke falls by {-1e6 * risen:.4g} um during a rising branch"
        yield Finding("stroke", what, "Change the sign of the stroke: a stack extends with rising voltage")
        return
    up, down = (
        np.nanmean([mean for branch, mean in zip(major, means, strict=True) if branch.rises == way], axis=0) for way in (True, False)
    )
    ahead = np.mean((up - down)[1:-1]) / size
    if ahead > _AHEAD:
        what = f"at equal voltage the stroke is {ahead:.1%} of its range larger on rising than on falling branches, so it leads the voltage"
        yield Finding("record", what, "Check for exchanged channels, or a delayed channel: the stroke of a stack lags the voltage")
    drops = [np.max(np.maximum.accumulate(mean) - mean) for mean in means]
    worst = np.argmax(drops)
    if drops[worst] > _FALL * size:
        yield _fall(major[worst], means[worst], volts, size)


def _bin(volts: Array, strokes: Array, branch: Branch) -> Array:
    """Mean strokes of a branch in equal bins of the record's range; empty bins are interpolated."""
    rows = slice(branch.start, branch.stop + 1)
    edges = np.linspace(np.min(volts), np.max(volts), _BINS + 1)
    place = np.clip(np.digitize(volts[rows], edges) - 1, 0, _BINS - 1)
    counts = np.bincount(place, minlength=_BINS)
    sums = np.bincount(place, strokes[rows], minlength=_BINS)
    there = np.flatnonzero(counts)
    return np.interp(np.arange(_BINS), there, sums[there] / counts[there])


def _fall(branch: Branch, mean: Array, volts: Array, size: float) -> Finding:
    highest = np.maximum.accumulate(mean)
    trough = np.argmax(highest - mean)
    peak = np.argmax(mean[: trough + 1])
    drop = highest[trough] - mean[trough]
    places = np.min(volts) + np.ptp(volts) * (np.array([peak, trough]) + 0.5) / _BINS
    what = f"on the branch from {branch.first:g} V to {branch.last:g} V the stroke is {1e6 * drop:.3g} um less at {places[1]:g} V"
    much = f"than at {places[0]:g} V ({drop / size:.1%} of its range)"
    return Finding("stroke", f"{what} {much}: a loop that is not monotonic has no inverse", "Look for slip, a resonance or a bad contact")
