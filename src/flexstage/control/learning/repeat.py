"""Repetitive control: removes periodic errors while a path runs, in the band where the loop is known well enough."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import scipy

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.record import INNER, Axes, Heading, Layout
from flexstage.base.units.quantity import FREQUENCY, TIME
from flexstage.control.learning.learn import BEYOND, IN_BAND, ByCoordinate, fade_ends, filter_path, line_grid, robust_band, wanted_readings
from flexstage.control.learning.responses import Band, frequencies_of, readings, scaled_norms
from flexstage.control.systems.closed import Loop

_MEMORY = 6.0
"""Length of the filters on each side, in periods of the band's end frequency."""
_MOST_OF_PERIOD = 0.45
_CONTRACTS, _LOWER, _WHOLE = 0.9, 0.85, 0.75
_OFFSETS, _PHASES, _FINEST = 5, 16, 8


@dataclass(frozen=True, eq=False)
class Repeater:
    """Repetitive controller. The correction is d = z^-P (W d + L e): it follows from correction d and error e one period P before.

    W is the low-pass filter of the `band`, with the taps `keep` (2m+1,). L, with the taps `teach` (2m+1, f, f), is the inverse model of the
    loop, multiplied by the learning gain and filtered by W. Both filters are noncausal: they also use the following m samples. If the
    `period` P [samples] is not a whole number, the taps include the fractional delay. `contraction` is the largest singular value of W - G
    L over all frequencies, with rotations scaled to lengths; G are the loop's responses with shifted modes. With a contraction below 1 the
    loop is stable and repeating errors decay (Inoue, Nakano et al., IFAC World Congress 1981; Tomizuka, Tsao & Chew, Journal of Dynamic
    Systems, Measurement, and Control 111 (1989) 353). `amplifies` is the largest amplification of errors between the harmonics, without
    mode shift: the largest singular value of (I - q W) (I - q (W - G L))^-1 over all frequencies and all complex numbers q with |q| = 1.
    """

    period: float
    keep: Array
    teach: Array
    band: Band
    contraction: float
    amplifies: float

    @property
    def reach(self) -> int:
        """Length m of the filters on each side, in samples."""
        return len(self.keep) // 2

    def at(self, frequencies: Array, step: float) -> tuple[Array, Array]:
        """Compute the responses of the filters W (n,) and L (n, f, f) at frequencies (n,) [Hz], without the fractional delay."""
        late = np.arange(-self.reach, self.reach + 1) + (np.floor(self.period + 0.5) - self.period)
        turned = np.exp(-2j * np.pi * np.outer(frequencies, late) * step)
        return turned @ self.keep, np.einsum("nk,kij->nij", turned, self.teach)


def repeater(closed: Loop, period: float, gain: float, spread: float) -> Repeater:
    """Design the filters for a `period` [s] in the widest band in which errors decrease, for relative mode shifts up to `spread`.

    `gain` multiplies the inverse model of the loop. Finite filters also act outside their band; therefore the band is narrower than for
    iterative learning. Raises `DesignError` like `robust_band`, and for a period so short that no usable band contains the first harmonic.
    """
    step, end = closed.step or 1.0, robust_band(closed, gain, spread).band.end
    lines = np.append(line_grid(closed, spread), 0.5 / step * (1.0 - 1e-9))
    moved = [readings(closed, lines, float(offset)) for offset in np.linspace(-spread, spread, _OFFSETS)]
    while _WHOLE * end > 1.0 / period:
        found = _repeater(closed, period, Band(end), gain)
        kept, taught = found.at(lines, step)
        own = kept[:, None, None] * np.eye(taught.shape[-1])
        contraction = max(float(np.max(scaled_norms(own - each @ taught, closed.plant.coordinates.scale))) for each in moved)
        if contraction < _CONTRACTS:
            worse = _amplification(own, own - moved[_OFFSETS // 2] @ taught, closed.plant.coordinates.scale)
            return replace(found, contraction=contraction, amplifies=worse)
        end *= _LOWER
    said = f"no filter reduces an error with a period of {period:.4g} s (first harmonic {1.0 / period:.4g} Hz)"
    raise refuse(
        "follow",
        f"{said} to less than {100.0 * _CONTRACTS:g} % from one period to the next",
        "Use a longer period (a slower scan), a smaller gain or spread, or iterative learning",
    )


def _repeater(closed: Loop, period: float, band: Band, gain: float) -> Repeater:
    """Filters of a band, before verification: advanced by a fraction of a sample, with windowed ends."""
    step = closed.step or 1.0
    samples = period / step
    reach = int(min(np.ceil(_MEMORY / (band.end * step)), _MOST_OF_PERIOD * samples))
    count = 2 ** int(np.ceil(np.log2(_FINEST * (2 * reach + 1))))
    lines = np.fft.rfftfreq(count, step)
    lines[0] = 1e-3 * lines[1]
    phase = np.exp(2j * np.pi * lines * step * (np.floor(samples + 0.5) - samples))
    back = gain * phase[:, None, None] * band.blend(lines, lambda inside: np.linalg.inv(readings(closed, inside)), 0.0)
    places = np.arange(-reach, reach + 1)
    window = 0.5 * (1.0 + np.cos(np.pi * places / (reach + 1.0)))
    keep, teach = (np.fft.irfft(each, n=count, axis=0)[places] for each in (band.gains(lines) * phase, back))
    return Repeater(samples, keep * window, teach * window[:, None, None], band, np.nan, np.nan)


def _amplification(kept: Array, left: Array, scale: Array) -> float:
    """Largest ||(I - q W) (I - q (W - P L))^-1|| over |q| = 1, for W (n, f, f) and W - P L."""
    own, turns = np.eye(left.shape[-1]), np.exp(2j * np.pi * np.arange(_PHASES) / _PHASES)
    return max(float(np.max(scaled_norms((own - z * kept) @ np.linalg.inv(own - z * left), scale))) for z in turns)


@dataclass(frozen=True, eq=False)
class RepetitiveResult:
    """Result of repetitive control along a path, for the loop's `coordinates` in their `units`.

    `rms` (periods, f) is the rms of the measured error over each `period`, limited to frequencies up to `band` [Hz]; the first period has
    no correction. `beyond` (f,) is the rms error of the last period at frequencies above the band. `contraction` is the largest contraction
    factor per period for relative mode shifts up to `spread`. `amplifies` is the largest amplification of non-repeating errors (at
    frequencies between the harmonics).
    """

    TABLE: ClassVar[Layout] = Layout(
        "Repetitive control",
        "first halfway last beyond",
        head="path, coordinate",
        notes=(
            (
                "{self.rms.shape[0]} periods of {self.period:.4g} s, with gain {self.gain:g} in the band up to {self.band:.4g} Hz. Each "
                "period multiplies the repeating error by at most {self.contraction:.3g} for relative mode shifts up to {self.spread:g}."
            ),
            "Errors at frequencies between the harmonics of the period {self.period:.4g} s are amplified by at most {self.amplifies:.3g}.",
            IN_BAND,
        ),
    )

    coordinates: tuple[str, ...]
    units: tuple[str, ...]
    period: Annotated[float, TIME]
    band: Annotated[float, FREQUENCY]
    contraction: float
    amplifies: float
    gain: float
    spread: float
    rms: Annotated[Array, Axes("periods", "coordinates")]
    beyond: Annotated[ByCoordinate, BEYOND]
    commanded: Annotated[Array, INNER]

    @property
    def first(self) -> Annotated[ByCoordinate, INNER, Heading("first period", digits=3)]:
        """Rms error (f,) of the first period."""
        return self.rms[0]

    @property
    def halfway(self) -> Annotated[ByCoordinate, INNER, Heading("middle period", digits=3)]:
        """Rms error (f,) of the middle period."""
        return self.rms[len(self.rms) // 2]

    @property
    def last(self) -> Annotated[ByCoordinate, INNER, Heading("last period", digits=3)]:
        """Rms error (f,) of the last period."""
        return self.rms[-1]


@dataclass(frozen=True, eq=False)
class Repetition:
    """Repetition of a path: its `period` [s], and the `window` of samples in which the path is periodic.

    `gain` is the learning gain, `spread` the largest relative mode shift.
    """

    period: float
    window: slice
    gain: float = 0.6
    spread: float = 0.02


def repeat(advance: Callable[[Array], Array], closed: Loop, wanted: Array, asked: Repetition) -> RepetitiveResult:
    """Simulate a run along a true path (n, f), with corrections from the errors of previous periods.

    `advance` continues the run with further commanded poses, and returns the measured poses. Only errors within `asked.window` are used;
    after this window the correction fades out. Raises `DesignError` like `repeater`.
    """
    found = repeater(closed, asked.period, asked.gain, asked.spread)
    target = wanted_readings(closed, wanted, found.band.end)
    added, error = np.zeros_like(wanted), np.zeros_like(wanted)
    learns, fades = _windows(len(wanted), asked.window, found.reach)
    block = max(int(found.period + 0.5) - found.reach, 1)
    for start in range(0, len(wanted), block):
        stop = min(start + block, len(wanted))
        added[start:stop] = _next(found, added, error * learns[:, None], start, stop) * fades[start:stop, None]
        error[start:stop] = target[start:stop] - advance(wanted[start:stop] + added[start:stop])
    return _repeated(found, closed, error, asked, wanted + added)


def _windows(count: int, window: slice, fade: int) -> tuple[Array, Array]:
    """Windows of the used errors and of the correction, which fades out after the former."""
    places = np.arange(count)
    learns = ((places >= window.start) & (places < window.stop)).astype(float)
    after = np.clip((places - window.stop) / max(fade, 1), 0.0, 1.0)
    return learns, 0.5 * (1.0 + np.cos(np.pi * after))


def _next(found: Repeater, added: Array, error: Array, start: int, stop: int) -> Array:
    """Correction W d + L e one period before, for the samples from `start` to `stop`."""
    first, last = start - int(found.period + 0.5) - found.reach, stop - int(found.period + 0.5) + found.reach
    if last <= 0:
        return np.zeros((stop - start, added.shape[1]))
    before = np.zeros((max(-first, 0), added.shape[1]))
    past, known = (np.concatenate([before, each[max(first, 0) : last]]) for each in (added, error))
    kept = scipy.signal.fftconvolve(past, found.keep[:, None], mode="valid", axes=0)
    return kept + np.sum(scipy.signal.fftconvolve(known[:, None, :], found.teach, mode="valid", axes=0), axis=-1)


def _repeated(found: Repeater, closed: Loop, error: Array, asked: Repetition, commanded: Array) -> RepetitiveResult:
    whole = Band(_WHOLE * found.band.end)
    error = error * fade_ends(len(error), asked.window)[:, None]
    inside = filter_path(whole.gains(frequencies_of(error, closed.step or 1.0)), error)
    starts = np.arange(asked.window.start, asked.window.stop - found.period + 1.0, found.period).round().astype(int)
    length = round(found.period)
    squares = [np.mean(inside[start : start + length] ** 2, axis=0) for start in starts]
    last = (error - inside)[starts[-1] : starts[-1] + length]
    return RepetitiveResult(
        coordinates=closed.plant.coordinates.names,
        units=closed.plant.coordinates.units,
        period=asked.period,
        band=whole.end,
        contraction=found.contraction,
        amplifies=found.amplifies,
        gain=asked.gain,
        spread=asked.spread,
        rms=np.sqrt(np.array(squares)),
        beyond=np.sqrt(np.mean(last**2, axis=0)),
        commanded=commanded,
    )
