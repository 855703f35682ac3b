"""Numbers of every channel of a record, gathered in one pass over its blocks: extremes, spread, standstill, what is missing."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.record import Record, Role

_BLOCK = 1 << 19
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
class Gathered:
    """Numbers of all channels; the longest stretch (start, stop) in which all are numbers; mean cross-spectra of the inputs, unscaled."""

    channels: tuple[Numbers, ...]
    stretch: tuple[int, int]
    input_spectra: Array
    segments: int


@dataclass(eq=False)
class _State:
    count: Array
    mean: Array
    square: Array
    low: Array
    high: Array
    broken: Array
    first_broken: Array
    step: Array
    last: Array
    run: Array
    still: Array
    still_from: Array
    still_at: Array
    pair_low: Array
    pair_high: Array
    spectra: Array
    tops: Array
    bottoms: Array
    seen: int = 0
    segments: int = 0
    segment: int = _SEGMENT
    whole_from: int = 0
    stretch: tuple[int, int] = (0, 0)
    inputs: list[int] = field(default_factory=list[int])


def gather(record: Record) -> Gathered:
    """One pass over a record. Memory is that of a block, whatever its length.

    >>> from flexstage.experiment.record import Channel, in_memory
    >>> found = gather(in_memory([Channel("S1", "um")], 1.0, np.array([[0.0], [1.0], [1.0], [np.nan]])))
    >>> found.stretch, found.channels[0].broken, found.channels[0].still, found.channels[0].at_high
    ((0, 3), 1, 2, 2)
    """
    state = _fresh(record)
    rows = max(1, _BLOCK // len(record.channels) // _SEGMENT) * _SEGMENT
    with np.errstate(over="ignore", invalid="ignore"):  # numbers near the largest double have no square
        for block in record.blocks(rows):
            _advance(state, block)
    state.stretch = _longer(state.stretch, (state.whole_from, state.seen))
    spectra = state.spectra / max(1, state.segments)
    return Gathered(tuple(_numbers(state, column) for column in range(len(record.channels))), state.stretch, spectra, state.segments)


def _fresh(record: Record) -> _State:
    size = len(record.channels)
    inputs = [number for number, channel in enumerate(record.channels) if channel.role is Role.INPUT]
    segment = _segment(record.length, len(inputs))
    return _State(
        count=np.zeros(size),
        mean=np.zeros(size),
        square=np.zeros(size),
        low=np.full(size, np.inf),
        high=np.full(size, -np.inf),
        broken=np.zeros(size, dtype=int),
        first_broken=np.full(size, -1),
        step=np.full(size, np.inf),
        last=np.full(size, np.nan),
        run=np.zeros(size, dtype=int),
        still=np.zeros(size, dtype=int),
        still_from=np.zeros(size, dtype=int),
        still_at=np.full(size, np.nan),
        pair_low=np.full(size, np.inf),
        pair_high=np.full(size, -np.inf),
        spectra=np.zeros((segment // 2 + 1, len(inputs), len(inputs)), dtype=complex),
        tops=np.full((0, size), -np.inf),
        bottoms=np.full((0, size), np.inf),
        inputs=inputs,
        segment=segment,
    )


def _segment(length: int, inputs: int) -> int:
    """Samples of a segment: 1024, in short records so few that 16 segments an input remain."""
    most = max(2, length // (16 * max(1, inputs)))
    return min(_SEGMENT, 1 << (most.bit_length() - 1))


def _advance(state: _State, block: Array) -> None:
    finite = np.isfinite(block)
    _moments(state, block, finite)
    _extremes(state, block, finite)
    _missing(state, finite)
    for column in range(block.shape[1]):
        _standstill(state, block[:, column], column)
    _spectra(state, block[:, state.inputs])
    state.seen += len(block)


def _moments(state: _State, block: Array, finite: Array) -> None:
    count = finite.sum(axis=0)
    plain = np.where(finite, block, 0.0)
    mean = plain.sum(axis=0) / np.maximum(count, 1)
    square = (np.where(finite, block - mean, 0.0) ** 2).sum(axis=0)
    total = np.maximum(state.count + count, 1)
    shift = np.where(count > 0, mean - state.mean, 0.0)
    state.square = state.square + square + shift**2 * state.count * count / total
    state.mean = state.mean + shift * count / total
    state.count = state.count + count


def _extremes(state: _State, block: Array, finite: Array) -> None:
    """The highest and the least values so far, enough of them to tell a pile from a tail."""
    tops = np.concatenate([state.tops, np.where(finite, block, -np.inf)])
    bottoms = np.concatenate([state.bottoms, np.where(finite, block, np.inf)])
    kept = min(_KEPT, len(tops))
    state.tops = np.partition(tops, len(tops) - kept, axis=0)[len(tops) - kept :]
    state.bottoms = np.partition(bottoms, kept - 1, axis=0)[:kept]
    state.high, state.low = state.tops.max(axis=0), state.bottoms.min(axis=0)


def _missing(state: _State, finite: Array) -> None:
    broken = (~finite).sum(axis=0)
    first = np.argmin(finite, axis=0) + state.seen
    state.first_broken = np.where((state.first_broken < 0) & (broken > 0), first, state.first_broken)
    state.broken = state.broken + broken
    for row in np.flatnonzero(~finite.all(axis=1)):
        state.stretch = _longer(state.stretch, (state.whole_from, state.seen + int(row)))
        state.whole_from = state.seen + int(row) + 1


def _longer(one: tuple[int, int], other: tuple[int, int]) -> tuple[int, int]:
    return other if other[1] - other[0] > one[1] - one[0] else one


def _standstill(state: _State, values: Array, column: int) -> None:
    """The longest run of equal values, and the smallest step between unequal ones."""
    whole = np.concatenate([[state.last[column]], values])
    steps = np.abs(np.diff(whole))
    pairs = values[steps == 0.0]
    state.pair_low[column] = min(float(state.pair_low[column]), float(pairs.min(initial=np.inf)))
    state.pair_high[column] = max(float(state.pair_high[column]), float(pairs.max(initial=-np.inf)))
    moves = np.flatnonzero(~(steps == 0.0))
    unequal = steps[moves][np.isfinite(steps[moves])]
    state.step[column] = min(float(state.step[column]), float(unequal.min(initial=np.inf)))
    starts = np.concatenate([[-int(state.run[column])], moves])
    lengths = np.diff(np.concatenate([starts, [len(values)]]))
    longest = int(np.argmax(lengths))
    if lengths[longest] > state.still[column]:
        state.still[column], state.still_from[column] = lengths[longest], state.seen + starts[longest]
        state.still_at[column] = values[max(0, int(starts[longest]))]
    state.run[column], state.last[column] = lengths[-1], values[-1]


def _spectra(state: _State, inputs: Array) -> None:
    """Cross-spectra of the inputs, by segments with a Hann window; segments with gaps are left out."""
    size = state.segment
    count = len(inputs) // size
    if inputs.shape[1] < 2 or not count:
        return
    pieces = inputs[: count * size].reshape(count, size, -1)
    pieces = pieces[np.isfinite(pieces).all(axis=(1, 2))]
    window = np.hanning(size + 1)[:-1]
    lines = np.fft.rfft((pieces - pieces.mean(axis=1, keepdims=True)) * window[:, None], axis=1)
    state.spectra += np.einsum("sfi,sfj->fij", lines.conj(), lines)
    state.segments += len(pieces)


def _numbers(state: _State, column: int) -> Numbers:
    low, high = float(state.low[column]), float(state.high[column])
    at_low, next_low = _piles(state.bottoms[:, column])
    at_high, next_high = _piles(-state.tops[:, column])
    return Numbers(
        broken=int(state.broken[column]),
        first_broken=int(state.first_broken[column]),
        mean=float(state.mean[column]),
        rms=float(np.sqrt(state.square[column] / max(1.0, state.count[column]))),
        low=low,
        high=high,
        at_low=at_low,
        next_low=next_low,
        flat_low=bool(state.pair_low[column] == low),
        at_high=at_high,
        next_high=next_high,
        flat_high=bool(state.pair_high[column] == high),
        levels=(high - low) / float(state.step[column]) if np.isfinite(state.step[column]) else 0.0,
        still_from=int(state.still_from[column]),
        still=int(state.still[column]),
        still_at=float(state.still_at[column]),
    )


def _piles(values: Array) -> tuple[int, int]:
    """How often the least value occurs, and the next."""
    _, counts = np.unique(values[np.isfinite(values)], return_counts=True)
    first = [int(count) for count in counts[:2]]
    return first[0] if first else 0, first[1] if len(first) > 1 else 0


def explained(spectra: Array) -> Array:
    """Share of each input's power that is explained by the others, (inputs,): 1 - sum of 1/(G^-1)_ii over sum of G_ii.

    Multiple coherence, weighted with power (Bendat and Piersol, Random Data, 4th edition, section 7.3); delays within a segment count.

    >>> explained(np.array([[[1.0, 0.8], [0.8, 1.0]]])).round(2).tolist()
    [0.64, 0.64]
    """
    size = spectra.shape[1]
    power = np.real(np.einsum("fii->fi", spectra))
    level = power.sum(axis=0) / max(1, len(spectra))
    scale = np.sqrt(np.outer(level, level))
    scaled = spectra / np.where(scale > 0.0, scale, 1.0) + 1e-12 * np.eye(size)
    rest = 1.0 / np.real(np.einsum("fii->fi", np.linalg.inv(scaled)))
    return 1.0 - rest.sum(axis=0) / np.maximum((power / np.where(level > 0.0, level, 1.0)).sum(axis=0), 1e-300)
