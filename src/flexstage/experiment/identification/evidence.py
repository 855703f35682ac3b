"""Identification data from any source: frequency responses for candidate modes, and transform lines for the fit of modes."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.experiment.identification.outputs.tones import Tone, remove_tones
from flexstage.experiment.progress import each_part, part, report
from flexstage.experiment.records.record import Channel, Record, Responses, names_of, rising_problem
from flexstage.experiment.spectral.cross_spectra import Segments, Spectra, Window, pool, spectra
from flexstage.experiment.spectral.growth import noise_growth
from flexstage.experiment.spectral.lines import Cells, Lines, auto_powers, block_count, in_band, record_lines
from flexstage.experiment.spectral.smear import SMEARING, WindowLeakage
from flexstage.experiment.spectral.transfer import h1, multiple_coherence, noise_density

_SEGMENTS = 24.0
_PER_INPUT = 3.0
_LONGEST, _WHOLE = 32_768, 1 << 20
_ONCE, _DRIVEN, _FEWEST, _SHORTEST = 1.7, 1e-3, 8, 64
_HIGHEST = 0.42
_LOWEST_LINES = 3
_RUNNING = 10
_PASSES = 4  # for tones, spectra, the fit of modes, and the test of excitation
_ROUNDING = 1e-13
"""Relative error of sums of about a thousand double-precision numbers."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """Identification data: frequency responses for candidate modes, and transform lines for the fit.

    `responses` are in the channels' own units; `weights` (f, p) are the weights of the outputs. `lines()` returns the lines of all blocks,
    with inputs and outputs divided by `input_scale` (m,) and `output_scale` (p,). `density` (f, p) is the noise variance per line, in the
    channels' own units. `band` is the range of the data in Hz, `resolution` the line spacing in Hz. `inflation` multiplies variances
    because neighbouring lines are correlated. `coherence` (f, p) is the multiple coherence, if known. `rounding` (p,) is the scaled
    variance per line caused by rounding of samples. `tones` are all tones found in the outputs; the steady ones are removed. `stored` is
    true for an analyser's responses, `unstated` if the analyser's window is unknown.
    """

    where: str
    responses: Responses
    weights: Array
    lines: Callable[..., Iterable[Lines]]
    input_scale: Array
    output_scale: Array
    density: Array
    rate: float
    band: tuple[float, float]
    inflation: float = 1.0
    coherence: Array | None = None
    averages: float = 0.0
    smear: WindowLeakage | None = None
    rounding: Array | float = 0.0
    resolution: float = 0.0
    tones: tuple[Tone, ...] = ()
    stored: bool = False
    shaped: Callable[[Cells], Array] | None = None
    unstated: bool = False

    def apart(self, frequencies: Array) -> Array:
        """Return the spacing of lines in Hz near `frequencies` in Hz: `resolution`, or the local spacing if lines are unevenly spaced."""
        lines = self.responses.frequencies
        if not self.stored or is_even(lines):
            return np.full(np.shape(frequencies), self.resolution)
        return np.interp(frequencies, 0.5 * (lines[1:] + lines[:-1]), np.diff(lines))

    def shape(self, cells: Cells) -> Array:
        """Return the relative noise variance (p, c) of every output in each cell, from stored coherence or `noise_growth`; otherwise 1."""
        return np.ones((len(self.output_scale), len(cells.low))) if self.shaped is None else self.shaped(cells)

    def variance(self, low: float, high: float) -> Array:
        """Estimate the noise variance (p,) per line of the scaled outputs: the median over the lines from `low` to `high` in Hz."""
        inside = in_band(self.responses.frequencies, (low, high))
        chosen = self.density[inside] if np.any(inside) else self.density
        floor = 1e-10 * np.max(self.density, axis=0)
        return np.maximum(np.median(chosen, axis=0), floor) / self.output_scale**2


def evidence(what: Record | Responses | Sequence[Record], segments: Segments | None, known: Sequence[Spectra] = ()) -> Evidence:
    """Extract the identification data of a record, of several records of one stage, or of an analyser's responses.

    `known` are spectra of the records, one for each. Known spectra are used if their segments match and no tone was removed from the
    record.

    >>> from flexstage.experiment.example import one_mode_record
    >>> round(evidence(one_mode_record(), None).band[1], 2)
    26.88
    """
    if isinstance(what, Responses):
        return _of_responses(what)
    made = (what,) if isinstance(what, Record) else tuple(what)
    require(_findings(made))
    with part(0.0, 1.0 / _PASSES):
        records, tones = zip(*each_part(remove_tones, made), strict=True)
    chosen = segments or choose_segments(records)
    usable = {id(record): each for record, each in zip(made, known, strict=False) if each.segments == chosen}
    with part(1.0 / _PASSES, 2.0 / _PASSES):
        parts = each_part(lambda record: usable.get(id(record)) or spectra(record, chosen), records)
    together = pool([each.driven(names_of(each.inputs)) for each in parts])
    return replace(_of_records(records, together), tones=tuple(itertools.chain(*tones)))


def _of_records(records: tuple[Record, ...], known: Spectra) -> Evidence:
    rate, source = records[0].rate, records[0].where
    band = (float(known.frequencies[1] * _LOWEST_LINES), float(_HIGHEST * rate))
    inside = known.band(*band)
    responses = h1(known)
    is_single = known.averages <= len(known.inputs)
    drive = np.real(np.trace(known.xx, axis1=1, axis2=2))
    noise = _single_noise(known, responses) if is_single else noise_density(known)
    names = names_of(known.inputs)
    size = _scale(inside.yy, rate)
    input_scale, output_scale = _divisor(_scale(inside.xx, rate)), _divisor(size)

    def lines(number: int = 0, parts: int = 1) -> Iterable[Lines]:
        column = len(names)
        for index, record in enumerate(records, start=(2 + number) * len(records)):
            kept = record.select([channel.name for channel in record.channels if channel in record.outputs or channel.name in names])
            places = tuple(names.index(channel.name) for channel in kept.inputs)
            blocks = block_count(kept, parts)
            for done, block in enumerate(record_lines(kept, places, column, parts), start=1):
                report((index + done / blocks) / (_PASSES * len(records)))
                yield _scale_lines(block, input_scale, output_scale)
            column += blocks

    weights = 1.0 / np.sqrt(np.maximum(noise, 1e-12 * np.max(noise, axis=0) + 1e-300))
    weights = weights * np.sqrt(drive / np.max(drive))[:, None] if is_single else weights
    return Evidence(
        where=source,
        responses=replace(responses, source=source),
        weights=weights,
        lines=lines,
        input_scale=input_scale,
        output_scale=output_scale,
        density=noise * rate / 2.0,
        rate=rate,
        band=band,
        coherence=multiple_coherence(known),
        averages=known.independent,
        rounding=_rounding(known.outputs, size),
        resolution=max(1.0 / record.duration for record in records),
    )


def _single_noise(known: Spectra, responses: Responses) -> Array:
    """Noise density (f, p) of outputs without averages: from differences of neighbouring lines, uniform over all lines."""
    rough = _roughness(responses.frequencies, responses.values) * auto_powers(known.xx)[1:-1, None]
    return np.repeat(np.median(rough, axis=(0, 2))[None], len(responses.frequencies), axis=0)


def _scale(density: Array, rate: float) -> Array:
    """Root mean square per line, zero without signal."""
    return np.sqrt(np.mean(auto_powers(density), axis=0) * rate / 2.0)


def _divisor(scale: Array) -> Array:
    return np.where(scale > 0.0, scale, 1.0)


def _rounding(outputs: tuple[Channel, ...], scale: Array) -> Array:
    """Rounding relative to the sums: to the largest channel of the same unit.

    An output without signal has unknown resolution; any variance is acceptable.
    """
    largest = np.array([max(value for other, value in zip(outputs, scale, strict=True) if other.unit == each.unit) for each in outputs])
    return np.where(scale > 0.0, (_ROUNDING * largest / _divisor(scale)) ** 2, 1.0)


def _scale_lines(lines: Lines, input_scale: Array, output_scale: Array) -> Lines:
    factors = [input_scale[column] if column < len(input_scale) else 1.0 for column in lines.columns]
    return replace(lines, drive=lines.drive / np.array(factors), outputs=lines.outputs / output_scale)


def choose_segments(records: Sequence[Record], wanted: float = _SEGMENTS) -> Segments:
    """Choose the segments of records for spectra: about `wanted` segments, and at least three for each input.

    Long segments resolve sharp resonances; many segments average the noise. A single sweep excites each frequency only once: averaging is
    impossible. The segment for a single sweep is the whole record (at most 2^20 samples), without a window.

    >>> from flexstage.experiment.example import one_mode_record
    >>> choose_segments([one_mode_record(seconds=48.0)]).seconds
    2.0
    """
    inputs = len({channel.name for record in records for channel in record.inputs})
    shortest = min(record.duration for record in records)
    if all(_is_swept_once(record, Segments(record.duration / wanted, 0.0)) for record in records):
        return whole_segment(records, _WHOLE)
    needed = max(wanted, _PER_INPUT * inputs) / len(records)
    seconds = min(shortest / max(4.0, needed), _LONGEST / records[0].rate)
    return Segments(max(seconds, min(shortest, 16.0 / records[0].rate)))


def _is_swept_once(record: Record, segments: Segments) -> bool:
    """Whether a single input excites each frequency in only one segment: (sum P)^2 / sum P^2 = 1 for their powers P."""
    size = round(segments.seconds * record.rate)
    if len(record.inputs) != 1 or size < _SHORTEST:
        return False
    window = segments.window.samples(size)[:, None]
    source = record.select([record.inputs[0].name])
    power = np.array(
        [np.abs(np.fft.rfft(window * (block - np.mean(block)), axis=0)[1:, 0]) ** 2 for block in source.blocks(size) if len(block) == size]
    )
    total = np.sum(power, axis=0)
    driven = total > _DRIVEN * np.max(total)
    if len(power) < _FEWEST or not np.any(driven):
        return False
    often = total[driven] ** 2 / np.sum(power[:, driven] ** 2, axis=0)
    lines = np.bincount(np.argmax(power[:, driven], axis=0))  # an impact is in one segment
    return bool(np.median(often) < _ONCE and np.max(lines) < 0.5 * np.sum(lines))


def whole_segment(records: Sequence[Record], most: int = _LONGEST) -> Segments:
    """Return one segment without a window, as long as the shortest record (at most `most` samples), for an impact or a burst.

    >>> from flexstage.experiment.example import one_mode_record
    >>> whole_segment([one_mode_record(seconds=48.0)]).seconds
    48.0
    """
    shortest = min(record.duration for record in records)
    return Segments(min(shortest, most / records[0].rate), 0.0, Window.BOXCAR)


def _of_responses(known: Responses) -> Evidence:
    steps = np.diff(known.frequencies)
    _refuse_responses(known)
    size = np.sqrt(np.mean(np.abs(known.values) ** 2, axis=(0, 2)))
    output_scale = _divisor(size)
    count = known.values.shape[2]
    rough = _roughness(known.frequencies, known.values)
    density = np.repeat(np.median(rough, axis=(0, 2))[None, :], len(known.frequencies), axis=0)
    density = np.maximum(density, 1e-12 * output_scale**2)

    def lines(_: int = 0, __: int = 1) -> Iterable[Lines]:
        for index in range(count):
            yield Lines(known.frequencies, np.ones((len(steps) + 1, 1), dtype=complex), known.values[:, :, index] / output_scale, (index,))

    step, even = float(np.median(steps)), is_even(known.frequencies)
    window = next((each for each in Window if known.window.lower().startswith(each.value)), None)
    return Evidence(
        where=known.where,
        responses=known,
        weights=1.0 / np.sqrt(density),
        lines=lines,
        input_scale=np.ones(count),
        output_scale=output_scale,
        density=density,
        rate=np.nan,
        band=(float(max(known.frequencies[0], _LOWEST_LINES * steps[0])), float(known.frequencies[-1])),
        stored=True,
        unstated=not known.window,
        inflation=1.0 if window is None else _INFLATION[window],
        averages=float(known.averages or 0),
        smear=WindowLeakage(window, 1.0 / step) if even and window in SMEARING else None,
        rounding=_rounding(known.outputs, size),
        resolution=step,
        shaped=_shape(known, output_scale),
    )


def _shape(known: Responses, output_scale: Array) -> Callable[[Cells], Array] | None:
    """Noise over frequency: from coherence, else proportional to the response if the lines show it, else uniform."""
    coherence = known.coherence
    if coherence is not None:
        return lambda cells: _coherent_shape(known, coherence, cells)
    growth = noise_growth(known.frequencies, known.values / output_scale[:, None])
    if not np.any(growth):
        return None
    return lambda cells: 1.0 + growth[:, None] * cells.own_power.T / cells.count


def _coherent_shape(known: Responses, coherence: Array, cells: Cells) -> Array:
    """Noise level |H|^2 (1 - g^2) / g^2, proportional to an estimate's variance (Bendat & Piersol, ch. 9), at the cells' midpoints.

    Running median over 21 lines: a single prominent line is not noise.
    """
    share = np.clip(coherence, 1e-3, 1.0 - 1e-6)
    power = np.abs(known.values) ** 2 * (1.0 - share) / share
    reach = min(_RUNNING, len(power) - 1)
    padded = np.pad(power, ((reach, reach), (0, 0), (0, 0)), mode="reflect")
    power = np.median(np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1, axis=0), axis=-1)
    column = np.array([columns[0] for columns in cells.columns])[cells.block]
    line = np.clip(np.searchsorted(known.frequencies, cells.middle), 0, len(known.frequencies) - 1)
    return np.maximum(power[line, :, column].T, 1e-12 * np.max(power, axis=(0, 2))[:, None])


_INFLATION = {Window.BOXCAR: 1.0, Window.HANN: 1.94, Window.HAMMING: 1.82, Window.BLACKMAN: 2.35}
"""Sum over lines of the squared correlation of a window's lines: 1 + 2 (4/9 + 1/36) = 1.94 for Hann's."""


def _refuse_responses(known: Responses) -> None:
    """Raise `DesignError` for too few frequencies, frequencies that decrease, and values that are not numbers."""
    if len(known.frequencies) < 16:
        raise refuse(known.where, f"too few frequencies (got {len(known.frequencies)})", "Use responses at 16 frequencies or more")
    if broken := int(np.sum(~np.isfinite(known.values))):
        raise refuse(known.where, f"{broken} values are not numbers", "Omit these channels or frequencies")
    if (falling := rising_problem(known.frequencies)) is not None:
        raise refuse(known.where, falling, "Export each frequency once, from the lowest to the highest")


def is_even(frequencies: Array) -> bool:
    """Return whether lines are evenly spaced, to a thousandth of their spacing; the lines of stepped and swept sines are not.

    >>> is_even(np.arange(5.0)), is_even(np.geomspace(1.0, 9.0, 5))
    (True, False)
    """
    steps = np.diff(frequencies)
    return bool(np.max(np.abs(steps - np.mean(steps))) <= 1e-3 * np.mean(steps))


def _roughness(frequencies: Array, values: Array) -> Array:
    """Noise variance (f-2, p, m) from the distance of each line from the straight line through its neighbours, for any spacing."""
    share = ((frequencies[1:-1] - frequencies[:-2]) / (frequencies[2:] - frequencies[:-2]))[:, None, None]
    away = values[1:-1] - (1.0 - share) * values[:-2] - share * values[2:]
    return np.abs(away) ** 2 / (1.0 + share**2 + (1.0 - share) ** 2)


def _findings(records: tuple[Record, ...]) -> Iterator[Finding]:
    if not records:
        yield Finding("records", "no record", "Specify a record")
    for record in records:
        where, first = record.where, records[0]
        if not record.inputs:
            yield Finding(where, "no channel is an input", "Specify the input channels")
        if not record.outputs:
            yield Finding(where, "no channel is an output", "Specify the output channels")
        if record.rate != first.rate:
            what = f"it is sampled at {record.rate:g} Hz, the first record at {first.rate:g} Hz"
            yield Finding(where, what, "Sample all at the same rate")
        names, wanted = (sorted(names_of(each.outputs)) for each in (record, first))
        if names != wanted:
            what = f"its outputs differ from the first record (got {', '.join(names)}, expected {', '.join(wanted)})"
            yield Finding(where, what, "Use the same output names in all records")
