"""Numbers of every channel of a record, gathered in one pass over its blocks: extremes, spread, standstill, what is missing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.progress import report
from flexstage.experiment.records.record import Record, Role

BLOCK = 1 << 19
"""Numbers in a block, of all channels together."""
_SEGMENT = 1024
_KEPT = 2048


@dataclass(frozen=True)
class Numbers:
    """What the samples of one channel are like.

    `broken` samples are not numbers, the first is number `first_broken`. `rms` is about the mean. `at_low` samples (or more) are equal to
    the least value, `next_low` to the one above it, `flat_low` says whether two in a row are; so for the highest. `levels` is the range
    over the smallest step. From sample `still_from` the value stays `still_at` for `still` samples, longer than anywhere else.
    """

    broken: int
    first_broken: int
    mean: float
    rms: float
    low: float
    high: float
    at_low: int
    next_low: int
    flat_low: bool
    at_high: int
    next_high: int
    flat_high: bool
    levels: float
    still_from: int
    still: int
    still_at: float


@dataclass(frozen=True, eq=False)
class RecordNumbers:
    """Numbers of all channels; the longest stretch (start, stop) in which all are numbers; mean cross-spectra of the inputs, unscaled."""

    channels: tuple[Numbers, ...]
    stretch: tuple[int, int]
    input_spectra: Array
    segments: int


def gather(record: Record) -> RecordNumbers:
    """One pass over a record. Memory is that of a block, whatever its length.

    >>> from flexstage.experiment.records.record import Channel, in_memory
    >>> found = gather(in_memory([Channel("S1", "um")], 1.0, np.array([[0.0], [1.0], [1.0], [np.nan]])))
    >>> found.stretch, found.channels[0].broken, found.channels[0].still, found.channels[0].at_high
    ((0, 3), 1, 2, 2)
    """
    size = len(record.channels)
    inputs = [number for number, channel in enumerate(record.channels) if channel.role is Role.INPUT]
    moments, extremes, gaps, spectra = _Moments(size), _Extremes(size), _Gaps(size), _Spectra(len(inputs), record.length)
    runs = [_Runs() for _ in range(size)]
    rows = max(1, BLOCK // size // _SEGMENT) * _SEGMENT
    with np.errstate(over="ignore", invalid="ignore"):  # numbers near the largest double have no square
        for number, block in enumerate(record.blocks(rows)):
            finite = np.isfinite(block)
            moments.add(block, finite)
            extremes.add(block, finite)
            gaps.add(finite)
            spectra.add(block[:, inputs])
            for run, values in zip(runs, block.T, strict=True):
                run.add(values)
            report(min(1.0, (number + 1) * rows / record.length))
    found = tuple(_numbers(column, moments, extremes, gaps, runs[column]) for column in range(size))
    return RecordNumbers(found, gaps.longest, spectra.sum / max(1, spectra.segments), spectra.segments)


class _Moments:
    """How many samples are numbers, their mean and the sum of squares about it, a column a channel."""

    def __init__(self, size: int) -> None:
        self.count = self.mean = self.square = np.zeros(size)

    def add(self, block: Array, finite: Array) -> None:
        count = finite.sum(axis=0)
        mean = np.where(finite, block, 0.0).sum(axis=0) / np.maximum(count, 1)
        square = (np.where(finite, block - mean, 0.0) ** 2).sum(axis=0)
        total = np.maximum(self.count + count, 1)
        shift = np.where(count > 0, mean - self.mean, 0.0)
        self.square = self.square + square + shift**2 * self.count * count / total
        self.mean = self.mean + shift * count / total
        self.count = self.count + count


class _Extremes:
    """The highest and the least values, enough of them to tell a pile from a tail."""

    def __init__(self, size: int) -> None:
        self.tops, self.bottoms = np.full((0, size), -np.inf), np.full((0, size), np.inf)

    def add(self, block: Array, finite: Array) -> None:
        tops = np.concatenate([self.tops, np.where(finite, block, -np.inf)])
        bottoms = np.concatenate([self.bottoms, np.where(finite, block, np.inf)])
        kept = min(_KEPT, len(tops))
        self.tops = np.partition(tops, len(tops) - kept, axis=0)[len(tops) - kept :]
        self.bottoms = np.partition(bottoms, kept - 1, axis=0)[:kept]


class _Gaps:
    """Samples that are no numbers, the first of each channel, and the longest stretch in which all are."""

    def __init__(self, size: int) -> None:
        self.broken, self.first = np.zeros(size, dtype=int), np.full(size, -1)
        self._seen = self._from = 0
        self._longest = (0, 0)

    def add(self, finite: Array) -> None:
        broken = (~finite).sum(axis=0)
        self.first = np.where((self.first < 0) & (broken > 0), np.argmin(finite, axis=0) + self._seen, self.first)
        self.broken = self.broken + broken
        for row in np.flatnonzero(~finite.all(axis=1)):
            self._longest = _longer(self._longest, (self._from, self._seen + int(row)))
            self._from = self._seen + int(row) + 1
        self._seen += len(finite)

    @property
    def longest(self) -> tuple[int, int]:
        return _longer(self._longest, (self._from, self._seen))


def _longer(one: tuple[int, int], other: tuple[int, int]) -> tuple[int, int]:
    return other if other[1] - other[0] > one[1] - one[0] else one


@dataclass
class _Runs:
    """Equal values in a row of one channel: the longest run, where and at what; the least and highest of pairs; the smallest step else."""

    longest: int = 0
    start: int = 0
    value: float = np.nan
    pair_low: float = np.inf
    pair_high: float = -np.inf
    step: float = np.inf
    _last: float = np.nan
    _run: int = 0
    _seen: int = 0

    def add(self, values: Array) -> None:
        steps = np.abs(np.diff(np.concatenate([[self._last], values])))
        pairs = values[steps == 0.0]
        self.pair_low = min(self.pair_low, float(pairs.min(initial=np.inf)))
        self.pair_high = max(self.pair_high, float(pairs.max(initial=-np.inf)))
        moves = np.flatnonzero(~(steps == 0.0))
        unequal = steps[moves][np.isfinite(steps[moves])]
        self.step = min(self.step, float(unequal.min(initial=np.inf)))
        starts = np.concatenate([[-self._run], moves])
        lengths = np.diff(np.concatenate([starts, [len(values)]]))
        at = int(np.argmax(lengths))
        if lengths[at] > self.longest:
            self.longest, self.start = int(lengths[at]), self._seen + int(starts[at])
            self.value = float(values[max(0, int(starts[at]))])
        self._run, self._last, self._seen = int(lengths[-1]), float(values[-1]), self._seen + len(values)


class _Spectra:
    """The sum of cross-spectra of the inputs, by segments with a Hann window; segments with gaps are left out.

    A segment has 1024 samples, in short records so few that 16 segments an input remain.
    """

    def __init__(self, inputs: int, length: int) -> None:
        most = max(2, length // (16 * max(1, inputs)))
        self._size = min(_SEGMENT, 1 << (most.bit_length() - 1))
        self.sum: Array = np.zeros((self._size // 2 + 1, inputs, inputs), dtype=complex)
        self.segments = 0

    def add(self, inputs: Array) -> None:
        count = len(inputs) // self._size
        if inputs.shape[1] < 2 or not count:
            return
        pieces = inputs[: count * self._size].reshape(count, self._size, -1)
        pieces = pieces[np.isfinite(pieces).all(axis=(1, 2))]
        window = np.hanning(self._size + 1)[:-1]
        lines = np.fft.rfft((pieces - pieces.mean(axis=1, keepdims=True)) * window[:, None], axis=1)
        self.sum += np.einsum("sfi,sfj->fij", lines.conj(), lines)
        self.segments += len(pieces)


def _numbers(column: int, moments: _Moments, extremes: _Extremes, gaps: _Gaps, runs: _Runs) -> Numbers:
    bottoms, tops = extremes.bottoms[:, column], extremes.tops[:, column]
    low, high = float(bottoms.min(initial=np.inf)), float(tops.max(initial=-np.inf))
    at_low, next_low = _piles(bottoms)
    at_high, next_high = _piles(-tops)
    return Numbers(
        broken=int(gaps.broken[column]),
        first_broken=int(gaps.first[column]),
        mean=float(moments.mean[column]),
        rms=float(np.sqrt(moments.square[column] / max(1.0, moments.count[column]))),
        low=low,
        high=high,
        at_low=at_low,
        next_low=next_low,
        flat_low=runs.pair_low == low,
        at_high=at_high,
        next_high=next_high,
        flat_high=runs.pair_high == high,
        levels=(high - low) / runs.step if np.isfinite(runs.step) else 0.0,
        still_from=runs.start,
        still=runs.longest,
        still_at=runs.value,
    )


def _piles(values: Array) -> tuple[int, int]:
    """How often the least value occurs, and the next."""
    _, counts = np.unique(values[np.isfinite(values)], return_counts=True)
    first = [int(count) for count in counts[:2]]
    return first[0] if first else 0, first[1] if len(first) > 1 else 0


def explained_share(spectra: Array) -> Array:
    """Share of each input's power that is explained by the others, (inputs,): 1 - sum of 1/(G^-1)_ii over sum of G_ii.

    Multiple coherence, weighted with power (Bendat and Piersol, Random Data, 4th edition, section 7.3); delays within a segment count.

    >>> explained_share(np.array([[[1.0, 0.8], [0.8, 1.0]]])).round(2).tolist()
    [0.64, 0.64]
    """
    size = spectra.shape[1]
    power = np.real(np.einsum("fii->fi", spectra))
    level = power.sum(axis=0) / max(1, len(spectra))
    scale = np.sqrt(np.outer(level, level))
    scaled = spectra / np.where(scale > 0.0, scale, 1.0) + 1e-12 * np.eye(size)
    rest = 1.0 / np.real(np.einsum("fii->fi", np.linalg.inv(scaled)))
    return 1.0 - rest.sum(axis=0) / np.maximum((power / np.where(level > 0.0, level, 1.0)).sum(axis=0), 1e-300)
