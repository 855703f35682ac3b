"""Iterative learning control (ILC): removes repeating errors pass by pass, in the band where the loop is known well enough."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, ClassVar, TypeAlias

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Along, Axes, Heading, Layout, UnitIn
from flexstage.base.units.quantity import FREQUENCY
from flexstage.control.learning.responses import Band, frequencies_of, motions, readings, scaled_norms, through
from flexstage.control.systems.closed import Loop

_CONTRACTS = 0.8
"""Largest contraction factor of the error per pass, for all mode shifts."""
_MOST_INVERTED = 100.0
"""Largest gain of the loop's inverse: beyond it noise would saturate the strokes."""
_OFFSETS, _LINES, _AROUND = 5, 600, 15
_REPEATS = 4
"""Runs with the learned input, which separate repeating from non-repeating errors."""


IN_BAND = "All errors are rms values, measured by the gauges. The last column is the error above the band, where nothing is learned."
ByCoordinate: TypeAlias = Annotated[Array, Along("coordinates"), UnitIn("units")]
BEYOND = Heading("beyond the band", digits=3)


@dataclass(frozen=True, eq=False)
class RobustBand:
    """Robust learning `band` with low-pass filter Q; `contraction` is the largest ||Q (I - gain P P_m^-1)|| (symbols: `robust_band`)."""

    band: Band
    contraction: float


@dataclass(frozen=True, eq=False)
class LearningResult:
    """Result of iterative learning in passes along the same path, for the loop's `coordinates` in their `units`.

    `rms` (passes, f) is the rms of the measured error in the window of `LearningSettings`, limited to frequencies up to `band` [Hz]. The
    first pass is without learning. The last row of `rms` is the rms over four runs with the learned input; `noise` (f,) is the
    non-repeating component of the errors of these runs. `beyond` (f,) is the rms error at frequencies above the band, where learning fades
    out. `contraction` is the largest contraction factor per pass for relative mode shifts up to `spread`; `gain` is the learning gain.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Iterative learning control",
        "before learned noise beyond",
        head="path, coordinate",
        notes=(
            (
                "{self.rms.shape[0]} passes, the first without learning, with gain {self.gain:g} in the band up to {self.band:.4g} Hz. "
                "Each pass multiplies the repeating error by at most {self.contraction:.3g} for relative mode shifts up to {self.spread:g}."
            ),
            IN_BAND,
        ),
    )

    coordinates: tuple[str, ...]
    units: tuple[str, ...]
    band: Annotated[float, FREQUENCY]
    contraction: float
    gain: float
    spread: float
    rms: Annotated[Array, Axes("passes", "coordinates")]
    noise: Annotated[ByCoordinate, Heading("non-repeating", digits=3)]
    beyond: Annotated[ByCoordinate, BEYOND]
    commanded: Annotated[Array, INNER]

    @property
    def before(self) -> Annotated[ByCoordinate, INNER, Heading("without learning", digits=3)]:
        """Error in the band (f,) without learning."""
        return self.rms[0]

    @property
    def learned(self) -> Annotated[ByCoordinate, INNER, Heading("last pass", digits=3)]:
        """Error in the band (f,) after the last pass."""
        return self.rms[-1]

    @property
    def above_noise(self) -> Annotated[Array, VIEW, Along("coordinates")]:
        """Ratio (f,) of the error after the last pass to the non-repeating error, both in the band."""
        return self.rms[-1] / self.noise


def robust_band(closed: Loop, gain: float, spread: float) -> RobustBand:
    """Find the frequency band in which ||I - gain P P_m^-1|| is at most 0.8, for relative mode shifts up to `spread`.

    P are the loop's responses with shifted modes, and P_m are its responses without shift. The norm is the largest singular value, with
    rotations scaled to lengths. If the norm is below 1 at all frequencies, the error decreases from pass to pass (Norrloef & Gunnarsson,
    International Journal of Control 75 (2002) 1114). The band also ends where ||P_m^-1|| first exceeds 100. Raises `DesignError` if these
    limits leave no band.
    """
    lines = line_grid(closed, spread)
    back = np.linalg.inv(readings(closed, lines))
    scale = closed.plant.coordinates.scale
    worst = np.zeros(len(lines))
    for offset in np.linspace(-spread, spread, _OFFSETS):
        left = np.eye(len(scale)) - gain * readings(closed, lines, float(offset)) @ back
        worst = np.maximum(worst, scaled_norms(left, scale))
    asked = scaled_norms(back, scale)
    beyond = np.flatnonzero((worst > _CONTRACTS) | (asked > _MOST_INVERTED))
    if len(beyond) and beyond[0] == 0:
        what = f"for mode shifts up to {100.0 * spread:g} %, one pass may multiply the error at {lines[0]:.3g} Hz by {worst[0]:.3g}"
        inverse = f"and the inverse of the loop amplifies by {asked[0]:.3g} (expected {_MOST_INVERTED:g} or less)"
        raise refuse("follow", f"{what} (expected {_CONTRACTS:g} or less), {inverse}", "Use a smaller gain or spread, or a faster loop")
    end = float(lines[beyond[0] - 1]) if len(beyond) else 0.45 / (closed.step or 1.0)
    band = Band(end)
    return RobustBand(band, float(np.max(worst[lines <= end] * band.gains(lines[lines <= end]))))


def line_grid(closed: Loop, spread: float) -> Array:
    """Return frequencies up to 0.45 of the sampling rate, dense around the range of each shifted mode."""
    highest, modes, ratios = 0.45 / (closed.step or 1.0), closed.plant.frequencies, np.minimum(closed.plant.ratios, 0.3)
    around = [
        mode * (1.0 + offset) * (1.0 + ratio * np.tan(np.linspace(-1.3, 1.3, _AROUND)))
        for offset in np.linspace(-spread, spread, _OFFSETS)
        for mode, ratio in zip(modes, ratios, strict=True)
    ]
    every = np.unique(np.concatenate([np.geomspace(1e-3 * modes[0], highest, _LINES), *around]))
    return every[(every >= 1e-3 * modes[0]) & (every <= highest)]


def wanted_readings(closed: Loop, wanted: Array, end: float) -> Array:
    """Compute the poses (n, k) that gauges measure on a true path (n, k). Lags are modelled at frequencies up to four times `end` [Hz]."""
    step = closed.step or 1.0
    frequencies = frequencies_of(wanted, step)
    band = Band(min(4.0 * end, 0.45 / step))
    seen = band.blend(frequencies, lambda lines: readings(closed, lines) @ np.linalg.inv(motions(closed, lines)))
    return through(seen, wanted)


@dataclass(frozen=True, eq=False)
class LearningSettings:
    """Learning parameters: number of `passes`, `gain`, largest mode shift `spread`. Errors are evaluated within the samples of `window`."""

    passes: int
    gain: float
    spread: float
    window: slice


def learn(run: Callable[[Array, int], Array], closed: Loop, wanted: Array, lesson: LearningSettings) -> LearningResult:
    """Learn the command for a true path (n, f) that is at rest at both ends: the path plus a correction d.

    After a pass with the error e, the new correction is Q (d + gain P_m^-1 e). P_m is the model's response from reference to measured pose,
    and Q the low-pass filter of the robust band. `run(path, number)` simulates pass `number` along a commanded path, and returns the
    measured poses (n, f). Raises `DesignError` like `robust_band`.
    """
    robust = robust_band(closed, lesson.gain, lesson.spread)
    frequencies = frequencies_of(wanted, closed.step or 1.0)
    filtered = robust.band.gains(frequencies)
    whole = Band(0.75 * robust.band.end).gains(frequencies)
    back = lesson.gain * robust.band.blend(frequencies, lambda lines: np.linalg.inv(readings(closed, lines)), 0.0)
    target, added, rms = wanted_readings(closed, wanted, robust.band.end), np.zeros_like(wanted), []
    fades = fade_ends(len(wanted), lesson.window)[:, None]

    def errors(number: int) -> Array:
        return (target - run(wanted + added, number)) * fades

    def inside(error: Array) -> Array:
        return filter_path(whole, error)[lesson.window]

    error = errors(0)
    for number in range(1, lesson.passes + 1):
        rms.append(_rms(inside(error)))
        added = filter_path(filtered, added) + through(back, error)
        error = errors(number)
    every = np.array([inside(each) for each in (error, *map(errors, range(lesson.passes + 1, lesson.passes + _REPEATS)))])
    rms.append(np.sqrt(np.mean(every**2, axis=(0, 1))))
    return LearningResult(
        coordinates=closed.plant.coordinates.names,
        units=closed.plant.coordinates.units,
        band=0.75 * robust.band.end,
        contraction=robust.contraction,
        gain=lesson.gain,
        spread=lesson.spread,
        rms=np.array(rms),
        noise=np.sqrt(np.mean(np.var(every, axis=0, ddof=1), axis=0)),
        beyond=_rms((error - filter_path(whole, error))[lesson.window]),
        commanded=wanted + added,
    )


def fade_ends(count: int, window: slice) -> Array:
    """Return a window function: 1 within `window`, fading to 0 at both ends. An abrupt end of the error would act as a step.

    >>> fade_ends(5, slice(2, 4)).tolist()
    [0.0, 0.5, 1.0, 1.0, 0.0]
    """
    places = np.arange(count)
    before, after = (window.start - places) / max(window.start, 1), (places - window.stop + 1) / max(count - window.stop, 1)
    return 0.5 * (1.0 + np.cos(np.pi * np.clip(np.maximum(before, after), 0.0, 1.0)))


def filter_path(gains: Array, path: Array) -> Array:
    """Filter a path (n, f) by real gains, without phase shift."""
    return through(gains[:, None, None] * np.eye(path.shape[1]), path)


def _rms(values: Array) -> Array:
    return np.sqrt(np.mean(values**2, axis=0))


def inverse_path(closed: Loop, wanted: Array, spread: float) -> Array:
    """Compute the command for a true path (n, f) that is at rest at both ends, with the inverse of the model in the robust band."""
    band = robust_band(closed, 1.0, spread).band
    frequencies = frequencies_of(wanted, closed.step or 1.0)
    return through(band.blend(frequencies, lambda lines: np.linalg.inv(motions(closed, lines))), wanted)
