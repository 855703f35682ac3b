"""Statistics of every channel of a record in one pass over its blocks: extremes, scatter, frozen values, missing samples."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW
from flexstage.experiment.progress import report
from flexstage.experiment.records.record import Record, Role

BLOCK = 1 << 19
"""Samples per block, of all channels together."""
_SEGMENT = 1024
_KEPT = 2048


@dataclass(frozen=True, eq=False)
class Numbers:
    """Statistics of the samples of one channel, accumulated block by block.

    `broken` of `count` samples are not finite; `first_broken` is the index of the first such sample. The longest interval of constant value
    starts at sample `still_from`, and has `still` samples with the value `still_at`. `lows` and `highs` are the lowest and the highest
    samples, at most 2048 of each; they show whether the signal is clipped. `step` is the smallest nonzero difference of successive samples.
    `pairs` are the lowest and the highest value that occurs in two successive samples.
    """

    count: int = 0
    broken: int = 0
    first_broken: int = -1
    mean: float = 0.0
    square: Annotated[float, INNER] = 0.0
    lows: Annotated[Array, INNER] = field(default_factory=lambda: np.zeros(0))
    highs: Annotated[Array, INNER] = field(default_factory=lambda: np.zeros(0))
    pairs: Annotated[tuple[float, float], INNER] = (np.inf, -np.inf)
    step: float = np.inf
    still: int = 0
    still_from: int = 0
    still_at: float = np.nan
    _last: Annotated[float, INNER] = np.nan
    _run: Annotated[int, INNER] = 0

    def add(self, values: Array) -> Numbers:
        """Return the statistics with a further block of samples (n,) included."""
        finite = np.isfinite(values)
        held = values[finite]
        first = self.count + int(np.argmin(finite)) if self.first_broken < 0 and len(held) < len(values) else self.first_broken
        before, total = self.count - self.broken, max(1, self.count - self.broken + len(held))
        mean = float(np.sum(held)) / max(1, len(held))
        shift = (mean - self.mean) * bool(len(held))
        return replace(
            self._with_runs(values),
            count=self.count + len(values),
            broken=self.broken + len(values) - len(held),
            first_broken=first,
            mean=self.mean + shift * len(held) / total,
            square=self.square + float(np.sum((held - mean) ** 2)) + shift * before * shift * len(held) / total,
            lows=_least(np.append(self.lows, held)),
            highs=-_least(-np.append(self.highs, held)),
        )

    def _with_runs(self, values: Array) -> Numbers:
        steps = np.abs(np.diff(np.append(self._last, values)))
        equal = values[steps == 0.0]
        moves = np.flatnonzero(~(steps == 0.0))
        starts = np.append(-self._run, moves)
        lengths = np.diff(np.append(starts, len(values)))
        at = int(np.argmax(lengths))
        begin, length = int(starts[at]), int(lengths[at])
        known = replace(self, still=length, still_from=self.count + begin, still_at=float(values[max(0, begin)]))
        return replace(
            known if length > self.still else self,
            pairs=(min(self.pairs[0], float(equal.min(initial=np.inf))), max(self.pairs[1], float(equal.max(initial=-np.inf)))),
            step=min(self.step, float(steps[moves][np.isfinite(steps[moves])].min(initial=np.inf))),
            _last=float(values[-1]),
            _run=int(lengths[-1]),
        )

    @property
    def rms(self) -> Annotated[float, VIEW]:
        """Root mean square of the samples' deviations from their mean."""
        return float(np.sqrt(self.square / max(1, self.count - self.broken)))

    @property
    def low(self) -> Annotated[float, VIEW]:
        """Lowest value."""
        return float(self.lows.min(initial=np.inf))

    @property
    def high(self) -> Annotated[float, VIEW]:
        """Highest value."""
        return float(self.highs.max(initial=-np.inf))

    @property
    def levels(self) -> Annotated[float, VIEW]:
        """Range of the values divided by the smallest step."""
        return (self.high - self.low) / self.step if np.isfinite(self.step) else 0.0


@dataclass(frozen=True, eq=False)
class RecordNumbers:
    """Statistics of all channels, the longest interval `stretch` (start, stop) of finite samples, and unscaled cross-spectra of inputs."""

    channels: tuple[Numbers, ...]
    stretch: tuple[int, int]
    input_spectra: Array
    segments: int


def gather(record: Record) -> RecordNumbers:
    """Gather the statistics in one pass over a record; only one block of samples is in memory at a time.

    >>> from flexstage.experiment.records.record import Channel, in_memory
    >>> found = gather(in_memory([Channel("S1", "um")], 1.0, np.array([[0.0], [1.0], [1.0], [np.nan]])))
    >>> found.stretch, found.channels[0].broken, found.channels[0].still, count_ends(found.channels[0].highs)
    ((0, 3), 1, 2, (2, 1))
    """
    inputs = [number for number, channel in enumerate(record.channels) if channel.role is Role.INPUT]
    size = min(_SEGMENT, 1 << (max(2, record.length // (16 * max(1, len(inputs)))).bit_length() - 1))
    spectra, segments = np.zeros((size // 2 + 1, len(inputs), len(inputs)), dtype=complex), 0
    channels = (Numbers(),) * len(record.channels)
    seen = begun = 0
    longest = (0, 0)
    with np.errstate(over="ignore", invalid="ignore"):  # squares of the largest doubles overflow
        for block in record.blocks(max(1, BLOCK // len(channels) // _SEGMENT) * _SEGMENT):
            channels = tuple(numbers.add(values) for numbers, values in zip(channels, block.T, strict=True))
            stops = np.append(np.flatnonzero(~np.isfinite(block).all(axis=1)), len(block)) + seen
            starts = np.append(begun, stops[:-1] + 1)
            stretches = zip(starts.tolist(), stops.tolist(), strict=True)
            longest = max(longest, *stretches, key=lambda stretch: stretch[1] - stretch[0])
            seen, begun = seen + len(block), int(starts[-1])
            if len(inputs) > 1:
                total, count = _segment_spectra(block[:, inputs], size)
                spectra, segments = spectra + total, segments + count
            report(seen / record.length)
    return RecordNumbers(channels, longest, spectra / max(1, segments), segments)


def _segment_spectra(inputs: Array, size: int) -> tuple[Array, int]:
    """Sum of cross-spectra of segments with a Hann window, and their number; segments with gaps are omitted."""
    count = len(inputs) // size
    pieces = inputs[: count * size].reshape(count, size, inputs.shape[1])
    pieces = pieces[np.isfinite(pieces).all(axis=(1, 2))]
    window = np.hanning(size + 1)[:-1]
    lines = np.fft.rfft((pieces - pieces.mean(axis=1, keepdims=True)) * window[:, None], axis=1)
    return np.einsum("sfi,sfj->fij", lines.conj(), lines), len(pieces)


def _least(values: Array) -> Array:
    return np.partition(values, _KEPT - 1)[:_KEPT] if len(values) > _KEPT else values


def count_ends(values: Array) -> tuple[int, int]:
    """Count the values equal to the highest value, and the values equal to the second highest.

    >>> count_ends(np.array([1.0, 3.0, 3.0, 2.0]))
    (2, 1)
    """
    counts = [*np.unique(values, return_counts=True)[1][::-1].tolist(), 0, 0]
    return counts[0], counts[1]


def explained_share(spectra: Array) -> Array:
    """Compute the fraction of each input's power that the other inputs explain, from cross-spectra (f, m, m) of m inputs.

    For input i, this fraction is the power-weighted multiple coherence 1 - (sum of 1/(G^-1)_ii) / (sum of G_ii) (Bendat and Piersol, Random
    Data, 4th edition, section 7.3). The sums are over the frequencies of the cross-spectra G. Delays between inputs have no influence if
    they are much shorter than a segment.

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
