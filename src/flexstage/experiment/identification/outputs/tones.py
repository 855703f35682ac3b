"""Tones in outputs but not in inputs, from mains or pumps: detected by Thomson's test, and removed from records."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.progress import report
from flexstage.experiment.records.record import ComputedSamples, Record, Samples, names_of
from flexstage.experiment.spectral.lines import block_count

_TAPERS = 8
_HALF, _LEAST = 64, 16
_CHUNK, _TOGETHER = 64, 256
_LOUD, _HELD = 8.0, 30.0
_ONCE_IN, _HELD_ONCE_IN, _SEEN_ONCE_IN = 1e-9, 1e-7, 1e-4
_MOST, _ROUNDS = 64, 4
_ZOOMS = 7
_SURELY = 5.0
_DEGREE, _CLOSE = 2, 1e-4


@dataclass(frozen=True, eq=False)
class Tone:
    """Sinusoid of constant `frequency` f [Hz] in samples `start` to `stop`: 2 Re(a exp(2 pi j f t)), with t = 0 at `start`.

    `amplitudes` (p,) are the complex amplitudes a of all outputs, zero for outputs without the tone. `chance` is the probability that noise
    looks like an equally pure sinusoid. `fades` is the fraction of the amplitude that decays from start to stop; zero for a steady tone. A
    tone that decays is a free oscillation, which is not removed from the record.
    """

    frequency: float
    amplitudes: Array
    start: int
    stop: int
    chance: float = 0.0
    fades: float = 0.0


def steady_tones(tones: Iterable[Tone]) -> tuple[Tone, ...]:
    """Select the tones without decay.

    >>> len(steady_tones([Tone(1.0, np.ones(1), 0, 8), Tone(2.0, np.ones(1), 0, 8, fades=0.2)]))
    1
    """
    return tuple(tone for tone in tones if not tone.fades)


def quiet_samples(samples: Samples, tones: Sequence[Tone], columns: tuple[int, ...], rate: float) -> Samples:
    """Subtract tones from the channels with indices `columns` of samples at `rate` [Hz].

    >>> from flexstage.experiment.records.record import InMemory
    >>> hum = Tone(0.25, np.array([0.5]), 0, 4)
    >>> left = quiet_samples(InMemory(np.array([[1.0], [0.0], [-1.0], [0.0]])), (hum,), (0,), 1.0).read(0, 2)
    >>> bool(np.max(np.abs(left)) < 1e-12)
    True
    """

    def read(start: int, stop: int) -> Array:
        found = np.array(samples.read(start, stop), dtype=float)
        for tone in tones:
            low, high = max(start, tone.start), min(start + len(found), tone.stop)
            if low < high:
                turned = np.exp(2j * np.pi * tone.frequency / rate * (np.arange(low, high) - tone.start))
                for column, amplitude in zip(columns, tone.amplitudes, strict=True):
                    if amplitude:
                        found[low - start : high - start, column] -= 2.0 * np.real(amplitude * turned)
        return found

    return ComputedSamples(samples.length, read)


def remove_tones(record: Record) -> tuple[Record, tuple[Tone, ...]]:
    """Remove steady tones from the outputs of a record, and return all tones.

    A tone is a sinusoid of constant amplitude and phase. After subtraction of the response to the inputs, the line of a tone has at least
    eight times the power of neighbouring lines. The line also passes Thomson's harmonic F-test (Thomson, Proc. IEEE 70 (1982) 1055, 13;
    with sine tapers, Riedel & Sidorenko 1995). The false-alarm rate is 1e-9 for noise and noise-excited resonances. Tones also present in
    an input remain in the record. Free oscillations also remain; they are tones with a decay of more than five standard deviations. A
    resonance without measurable decay counts as a tone, because the record cannot distinguish the two.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.records.record import InMemory
    >>> made = one_mode_record(seconds=16.0)
    >>> hum = np.sin(2.0 * np.pi * 15.03 * np.arange(made.length) / made.rate)
    >>> noisy = replace(made, samples=InMemory(made.values + np.array([0.0, 20.0]) * hum[:, None]))
    >>> quiet, found = remove_tones(noisy)
    >>> [round(tone.frequency, 2) for tone in found], bool(np.std(quiet.values - made.values) < 0.05), remove_tones(made)[1]
    ([15.03], True, ())
    """
    inputs, outputs = (record.columns(names_of(each)) for each in (record.inputs, record.outputs))
    parts = block_count(record)
    size = record.length // parts
    found: list[Tone] = []
    for start in range(0, parts * size, size):
        found += _tones_of_block(record, inputs, outputs, start, start + size)
        report((start + size) / (parts * size))
    if not steady_tones(found):
        return record, tuple(found)
    return replace(record, samples=quiet_samples(record.samples, steady_tones(found), outputs, record.rate)), tuple(found)


def _tones_of_block(record: Record, inputs: tuple[int, ...], outputs: tuple[int, ...], start: int, stop: int) -> list[Tone]:
    found: list[Tone] = []
    line = record.rate / (stop - start)
    for _ in range(_ROUNDS):
        block = quiet_samples(record.samples, steady_tones(found), outputs, record.rate).read(start, stop)[:, [*inputs, *outputs]]
        lines = np.fft.rfft(block - np.mean(block, axis=0), axis=0) / np.sqrt(stop - start)
        fading = [other.frequency for other in found if other.fades]
        seen = _block_tones(lines, len(inputs), line, start, stop)
        more = [each for each in seen if all(abs(each.frequency - other) > _TAPERS * line for other in fading)]
        found += more
        if not steady_tones(more):
            break
    return found


def _block_tones(lines: Array, inputs: int, spacing: float, start: int, stop: int) -> Iterator[Tone]:
    """Tones in outputs but not in inputs, from lines with a `spacing` in Hz."""
    for line in _prominent_lines(_unexplained_power(lines, inputs)):
        half = min(_HALF, line, len(lines) - 1 - line)
        if half < _LEAST:
            continue
        near = lines[line - half : line + half]
        if _is_in_inputs(np.abs(near[:, :inputs]) ** 2):
            continue
        rest = _local_residual(near[None, :, :inputs], near[None, :, inputs:])[0]
        both = [_test(np.concatenate([near[:, :inputs], each], axis=1), inputs) for each in (near[:, inputs:], rest)]
        test = min(both, key=lambda each: np.min(each.chance[inputs:]))
        chance, held = test.chance[inputs:], test.chance[:inputs]
        seen = chance < _SEEN_ONCE_IN
        if np.min(chance) < _ONCE_IN and np.all(held > _HELD_ONCE_IN):
            offset, fades = _refine_offset(test.slow[:, inputs:][:, seen], test.offset)
            offset, amplitudes = _fit_beside_drive(near[:, :inputs], rest[:, seen], offset)
            every = np.zeros(len(seen), dtype=complex)
            every[seen] = amplitudes
            yield Tone((line + offset) * spacing, every / np.sqrt(stop - start), start, stop, float(np.min(chance)), fades)


def _is_in_inputs(power: Array) -> bool:
    """Whether the middle of powers (f, m) is prominent in an input that consists of tones."""
    middle = len(power) // 2
    level = np.median(power, axis=0) / np.log(2.0)
    return bool(np.any(np.max(power[middle - 1 : middle + 2], axis=0) > _HELD * level))


def _unexplained_power(lines: Array, inputs: int) -> Array:
    """Powers (f, p) of the outputs unexplained by inputs, by a local polynomial for each interval of lines."""
    count = len(lines) // (2 * _HALF)
    if count < 1:
        return np.abs(lines[:, inputs:]) ** 2
    found = np.empty((len(lines), lines.shape[1] - inputs))
    for start in range(0, count, _TOGETHER):
        stop = min(count, start + _TOGETHER)
        part = lines[start * 2 * _HALF : stop * 2 * _HALF].reshape(stop - start, 2 * _HALF, -1)
        rest = _local_residual(part[:, :, :inputs], part[:, :, inputs:])
        found[start * 2 * _HALF : stop * 2 * _HALF] = np.abs(rest.reshape(-1, rest.shape[2])) ** 2
    last = lines[-2 * _HALF :][None]
    found[-2 * _HALF :] = np.abs(_local_residual(last[:, :, :inputs], last[:, :, inputs:])[0]) ** 2
    return found


def _local_residual(drive: Array, outputs: Array) -> Array:
    """Residual of the outputs (w, f, q) after polynomials in frequency times the drive (w, f, m) and 1: a local response and transient.

    Local polynomial method (Pintelon & Schoukens 2012, ch. 7); with too few lines for the inputs, the outputs unchanged.
    """
    lines = drive.shape[1]
    powers = np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, lines), _DEGREE)
    full = np.concatenate([drive, np.ones((len(drive), lines, 1))], axis=2)
    rows = (full[:, :, :, None] * powers[:, None, :]).reshape(len(drive), lines, -1)
    if rows.shape[2] > lines // 2:
        return outputs
    rows = rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-300)
    turned = np.conj(np.swapaxes(rows, 1, 2))
    gram = turned @ rows + 1e-13 * np.eye(rows.shape[2])
    return outputs - rows @ np.linalg.solve(gram, turned @ outputs)


def _prominent_lines(power: Array) -> list[int]:
    """Indices of prominent lines in one of the powers (f, p), the highest first, without neighbours.

    The level is interpolated between groups of lines: a step in it would rank a neighbour of a tone above the tone.
    """
    count = len(power) // _CHUNK
    if count < 1:
        return []
    level = np.median(power[: count * _CHUNK].reshape(count, _CHUNK, -1), axis=1) / np.log(2.0)
    middles = (np.arange(count) + 0.5) * _CHUNK
    smooth = [np.interp(np.arange(len(power)), middles, column) for column in np.log(np.maximum(level, 1e-300)).T]
    ratio = np.max(power / np.exp(np.stack(smooth, axis=1)), axis=1)
    chosen: list[int] = []
    for line in np.argsort(-ratio)[: 8 * _MOST]:
        if ratio[line] < _LOUD or len(chosen) == _MOST:
            break
        if all(abs(line - other) > _TAPERS for other in chosen):
            chosen.append(int(line))
    return chosen


@dataclass(frozen=True, eq=False)
class _Test:
    """Lines as a slow motion in time (t, q), and the false-alarm probability (q,) of a sinusoid, `offset` lines from the middle."""

    slow: Array
    offset: float
    chance: Array


def _test(lines: Array, inputs: int) -> _Test:
    """Thomson's harmonic F-test of lines (f, q), inputs first."""
    slow = np.fft.ifft(np.fft.ifftshift(lines, axes=0), axis=0) * len(lines)
    offsets, sums, tapers = _tapers(len(slow))
    own = (tapers @ slow).reshape(len(offsets), _TAPERS, -1)
    mean = np.einsum("k,dkq->dq", sums, own) / np.sum(sums**2)
    rest = np.sum(np.abs(own - sums[None, :, None] * mean[:, None]) ** 2, axis=1)
    ratio = np.abs(mean) ** 2 * np.sum(sums**2) / np.maximum(rest, 1e-300)
    best = int(np.argmax(np.max(ratio[:, inputs:], axis=1)))
    near = slice(max(0, best - 4), best + 5)
    chance = (1.0 + ratio) ** (1.0 - _TAPERS)
    return _Test(slow, float(offsets[best]), np.concatenate([np.min(chance[near, :inputs], axis=0), chance[best, inputs:]]))


@cache
def _tapers(size: int) -> tuple[Array, Array, Array]:
    """Offsets (d,) in lines, sums (k,) of sine tapers, and the tapers demodulated by the offsets (d k, t)."""
    time, order = np.arange(size), np.arange(1, _TAPERS + 1)
    tapers = np.sqrt(2.0 / (size + 1.0)) * np.sin(np.pi * np.outer(order, time + 1.0) / (size + 1.0))
    offsets = np.linspace(-1.0, 1.0, 33)
    turned = np.exp(-2j * np.pi * np.outer(offsets, time) / size)
    return offsets, np.sum(tapers, axis=1), (turned[:, None] * tapers).reshape(-1, size)


def _refine_offset(slow: Array, offset: float) -> tuple[float, float]:
    """Offset in lines of the spectral maximum under Hann's window, and the decaying share."""
    time = np.arange(len(slow))
    window = np.hanning(len(slow) + 1)[:-1]
    level = np.var(slow, axis=0)
    step = 1.0 / 16.0
    for _ in range(_ZOOMS):
        offsets = offset + step * np.linspace(-1.0, 1.0, 17)
        size = np.exp(-2j * np.pi * np.outer(offsets, time) / len(slow)) @ (window[:, None] * slow)
        offset = float(offsets[np.argmax(np.sum(np.abs(size) ** 2 / level, axis=1))])
        step /= 6.0
    turned = np.exp(-2j * np.pi * offset * time / len(slow))[:, None] * slow
    return offset, _fading_share(turned)


def _fit_beside_drive(drive: Array, rest: Array, offset: float) -> tuple[float, Array]:
    """Offset and amplitudes (q,) fitted to the residual after inputs, to exclude the stage's response."""
    place = np.arange(-(len(rest) // 2), len(rest) // 2)
    amplitudes = np.zeros(rest.shape[1], dtype=complex)
    for _ in range(_ZOOMS):
        kernels = np.stack([_line_shape(offset - place, order) for order in range(2)], axis=1)
        kernels = _local_residual(drive[None], kernels[None])[0]
        amplitudes, slopes = np.linalg.lstsq(kernels, rest, rcond=None)[0]
        offset += float(np.clip(np.real(np.vdot(amplitudes, slopes)) / np.sum(np.abs(amplitudes) ** 2), -0.25, 0.25))
    return offset, amplitudes


def _line_shape(away: Array, order: int) -> Array:
    """Integral over 0..1 of exp(2 pi j x t), or its derivative by x: a sinusoid's contribution to a line at distance x."""
    x = 2j * np.pi * np.where(np.abs(away) < _CLOSE, _CLOSE, away)
    turn = np.exp(x)
    return (turn - 1.0) / x if order == 0 else 2j * np.pi * (turn * (x - 1.0) + 1.0) / x**2


def _fading_share(turned: Array) -> float:
    """Share of amplitudes that decays from start to end, zero if below five deviations."""
    ends = len(turned) // 16
    kept = turned[ends:-ends]
    time = (np.arange(len(kept)) - 0.5 * (len(kept) - 1.0)) / len(turned)
    mean, slope = np.mean(kept, axis=0), time @ kept / np.sum(time**2)
    rest = np.mean(np.abs(kept - mean - time[:, None] * slope) ** 2, axis=0)
    weights = np.abs(mean) ** 2 / np.maximum(rest, 1e-300)
    rate = -float(np.sum(weights * np.real(slope / mean)) / np.sum(weights))
    deviation = 1.0 / np.sqrt(2.0 * np.sum(weights) * np.sum(time**2))
    return rate if rate > _SURELY * deviation else 0.0
