"""Auto- and cross-spectra of a record by Welch's method, in one pass over its blocks."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Annotated

import numpy as np

from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.base.record import INNER
from flexstage.base.units.quantity import FREQUENCY
from flexstage.experiment.progress import report
from flexstage.experiment.records.record import Channel, Record, names_of
from flexstage.experiment.spectral.lines import auto_powers, in_band

BATCH = 2_000_000


class Window(Enum):
    """Window function by which a segment is multiplied before its transform."""

    HANN = "hann"
    HAMMING = "hamming"
    BLACKMAN = "blackman"
    BOXCAR = "boxcar"

    def samples(self, size: int) -> Array:
        """Evaluate the window over a segment of `size` samples, in its periodic form (Harris 1978).

        >>> Window.HANN.samples(4).round(12).tolist()
        [0.0, 0.5, 1.0, 0.5]
        """
        terms = {"hann": (0.5, 0.5), "hamming": (0.54, 0.46), "blackman": (0.42, 0.5, 0.08), "boxcar": (1.0,)}[self.value]
        phase = 2.0 * np.pi * np.arange(size) / size
        return sum(((-1) ** order * factor * np.cos(order * phase) for order, factor in enumerate(terms)), np.zeros(size))


@dataclass(frozen=True)
class Segments(CheckedFields):
    """Segmentation of a record: length `seconds` of a segment (its inverse is the resolution in Hz), fractional `overlap`, and `window`."""

    seconds: Annotated[float, INNER]
    overlap: float = 0.5
    window: Window = Window.HANN


@dataclass(frozen=True, eq=False)
class Spectra:
    """One-sided spectral densities of m inputs and p outputs at f `frequencies` [Hz]: `xx` (f, m, m), `yx` (f, p, m), `yy` (f, p, p).

    X and Y are the transforms of the inputs and outputs, E is the mean over segments. `yx` is E[Y X^H]: entry (i, j) is output i times the
    conjugate of input j. `xx` is E[X X^H], and `yy` is E[Y Y^H]. The spectrum G_ij = E[X_i* Y_j] of Shin & Moon (equation 29) is yx[j, i].
    The unit of an entry is the product of the units of its two channels, per Hz. `averages` is the number of segments; `independent` is the
    equivalent number of segments without overlap.
    """

    frequencies: Array
    inputs: Annotated[tuple[Channel, ...], INNER]
    outputs: Annotated[tuple[Channel, ...], INNER]
    xx: Array
    yx: Array
    yy: Array
    averages: int
    independent: float
    segments: Segments

    @property
    def resolution(self) -> Annotated[float, FREQUENCY]:
        """Spacing of the frequency lines in Hz."""
        return float(self.frequencies[1])

    def driven(self, names: Container[str]) -> Spectra:
        """Return the spectra with only those inputs that are listed in `names` and have power."""
        power = np.sum(auto_powers(self.xx), axis=0)
        kept = np.array([index for index, each in enumerate(self.inputs) if each.name in names and power[index] > 0.0], dtype=int)
        inputs = tuple(self.inputs[index] for index in kept)
        return replace(self, inputs=inputs, xx=self.xx[:, kept[:, None], kept], yx=self.yx[:, :, kept])

    def band(self, low: float, high: float) -> Spectra:
        """Return the spectra at the lines from `low` to `high` in Hz, both included."""
        kept = in_band(self.frequencies, (low, high))
        return replace(self, **{name: getattr(self, name)[kept] for name in ("frequencies", "xx", "yx", "yy")})


@check_arguments
def spectra(record: Record, segments: Segments) -> Spectra:
    """Estimate the spectra of a record's inputs and outputs by Welch's method: averages over windowed, overlapping segments.

    Reference: Welch, IEEE Transactions on Audio and Electroacoustics 15 (1967) 70. The memory use does not depend on the record's length.
    The mean of each segment is subtracted. The window smears the estimate over about two frequency lines. Choose segments so long that
    several frequency lines lie within the width of the sharpest resonance. Raises `DesignError` for a record without outputs, or shorter
    than a segment.

    >>> from flexstage.experiment.records.record import Role, in_memory
    >>> noise = np.random.default_rng(0).standard_normal((64_000, 1))
    >>> both = in_memory([Channel("u", "V", Role.INPUT), Channel("y", "um", Role.OUTPUT)], 100.0, np.hstack([noise, 3.0 * noise]))
    >>> found = spectra(both, Segments(1.0))
    >>> round(float(np.mean(found.xx[5:-5].real)), 3), round(float(found.yx[7, 0, 0].real / found.xx[7, 0, 0].real), 6)
    (0.02, 3.0)
    """
    size = round(segments.seconds * record.rate)
    inputs, outputs = record.inputs, record.outputs
    require(_findings(record, size))
    chosen = record.select(names_of((*inputs, *outputs)))
    total, averages = _accumulate(chosen, size, segments)
    weight = segments.window.samples(size)
    density = total / (averages * record.rate * np.sum(weight**2))
    density[1 : (size + 1) // 2] *= 2.0
    count = len(inputs)
    return Spectra(
        frequencies=np.fft.rfftfreq(size, 1.0 / record.rate),
        inputs=inputs,
        outputs=outputs,
        xx=density[:, :count, :count],
        yx=density[:, count:, :count],
        yy=density[:, count:, count:],
        averages=averages,
        independent=independent_averages(averages, weight, _hop(size, segments)),
        segments=segments,
    )


def example_spectra() -> Spectra:
    """Return spectra of a small record whose output is three times its input, for examples.

    >>> example_spectra().averages
    7
    """
    from flexstage.experiment.records.record import Role, in_memory

    noise = np.random.default_rng(0).standard_normal((64, 1))
    channels = [Channel("u", "V", Role.INPUT), Channel("y", "um", Role.OUTPUT)]
    return spectra(in_memory(channels, 16.0, np.hstack([noise, 3.0 * noise])), Segments(1.0))


def independent_averages(averages: int, window: Array, hop: int) -> float:
    """Compute the number of non-overlapping segments equivalent to `averages` overlapping ones (Welch 1967, equation 11).

    Successive segments, with the same `window`, start `hop` samples apart.

    >>> independent_averages(10, np.ones(8), 8)
    10.0
    """
    own = np.sum(window**2)
    shifts = range(1, min(averages, -(-len(window) // hop)))
    shared = [(np.sum(window[hop * k :] * window[: -hop * k]) / own) ** 2 * (1.0 - k / averages) for k in shifts]
    return float(averages / (1.0 + 2.0 * sum(shared)))


def _findings(record: Record, size: int) -> Iterator[Finding]:
    where = record.where
    if not record.outputs:
        yield Finding(where, "no channel is an output", "Specify the output channels")
    if size < 8:
        yield Finding(where, f"segments are too short (got {size} samples)", "Use segments of 8 samples or more")
    elif record.length < size:
        lasts = f"the record is shorter than a segment ({record.duration:.4g} s and {size / record.rate:.4g} s)"
        yield Finding(where, lasts, "Use shorter segments, that is a coarser resolution, or record longer")


def _hop(size: int, segments: Segments) -> int:
    if not 0.0 <= segments.overlap < 1.0:
        raise refuse("segments", f"wrong overlap (got {segments.overlap:g})", "Use a fraction of at least 0 and less than 1")
    return max(1, round(size * (1.0 - segments.overlap)))


def _accumulate(record: Record, size: int, segments: Segments) -> tuple[Array, int]:
    """Sum over segments of the outer products (f, c, c) of their transforms, and the number of segments."""
    hop, window = _hop(size, segments), segments.window.samples(size)
    count = len(record.channels)
    total = np.zeros((size // 2 + 1, count, count), dtype=complex)
    together = max(1, BATCH // (size * count))
    averages = 0
    for block in record.blocks(size + hop * (together - 1), size - hop):
        if len(block) < size:
            break
        pieces = np.lib.stride_tricks.sliding_window_view(block, size, axis=0)[::hop]
        free = pieces - np.mean(pieces, axis=-1, keepdims=True)
        lines = np.moveaxis(np.fft.rfft(free * window, axis=-1), -1, 0)
        total += np.swapaxes(lines, 1, 2) @ np.conj(lines)
        averages += len(pieces)
        report(min(1.0, averages * hop / max(1, record.length - size + hop)))
    return total, averages


def pool(parts: Sequence[Spectra]) -> Spectra:
    """Combine spectra of several records, weighted by their numbers of averages; an input missing in a record counts as zero there.

    Inputs are in order of their first occurrence. All records must have the same frequency lines and the same outputs.

    >>> pool([example_spectra(), example_spectra()]).averages
    14
    """
    inputs = tuple({channel.name: channel for part in parts for channel in part.inputs}.values())
    names = names_of(inputs)
    first = parts[0]
    count = len(inputs)
    xx = np.zeros((len(first.frequencies), count, count), dtype=complex)
    yx = np.zeros((len(xx), len(first.outputs), count), dtype=complex)
    yy = np.zeros_like(first.yy)
    averages = sum(part.averages for part in parts)
    for part in parts:
        places = [names.index(channel.name) for channel in part.inputs]
        share = part.averages / averages
        xx[:, np.array(places)[:, None], places] += share * part.xx
        yx[:, :, places] += share * part.yx
        yy += share * part.yy
    independent = sum(part.independent for part in parts)
    return Spectra(
        first.frequencies, inputs, first.outputs, xx, yx, yy, averages=averages, independent=independent, segments=first.segments
    )
