"""Margins from measured or modelled frequency responses of a plant at frequency lines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array

_NOTHING = 1e-300
"""Magnitude |L| of open loops."""


@dataclass(frozen=True, eq=False)
class ResponseMargins:
    """Loop margins at frequency lines; `sizes` (f, n) are the sensitivities |S_ii| of each loop with the other loops closed.

    `peak` is the largest singular value of the sensitivity S, with rotations multiplied by the stage's length. Stability limits of each
    loop are the nearest gain factors below 1 (`lows`) and above 1 (`gains`), the `phases` [rad] and the `delays` [s]. `rejections` [Hz] are
    the first upward crossings of |S_ii| = 1 (NaN: no crossing).
    """

    sizes: Array
    peak: float
    peak_frequency: float
    lows: tuple[float, ...]
    gains: tuple[float, ...]
    phases: tuple[float, ...]
    delays: tuple[float, ...]
    rejections: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class LoopLines:
    """Frequency `lines` [Hz], the coordinates' `scale`, and the controller's response `control` (f, n, c) from error to command."""

    lines: Array
    scale: Array
    control: Array

    def sensitivity(self, plant: Array) -> Array:
        """Compute the sensitivity S (f, c, c) = (I + P K)^-1 for the responses P (f, c, n) from commands to pose; K is `control`."""
        return np.linalg.inv(np.eye(plant.shape[1]) + plant @ self.control)

    def margins(self, plant: Array) -> ResponseMargins:
        """Compute the peak of S and the margins for the responses (f, c, n) from commands to pose."""
        sensitivity = self.sensitivity(plant)
        peaks = np.linalg.norm(sensitivity * self.scale[:, None] / self.scale, 2, axis=(1, 2))
        place = int(np.argmax(peaks))
        own = np.diagonal(sensitivity, axis1=1, axis2=2)
        loops = [1.0 / each - 1.0 for each in own.T]
        lows, gains = zip(*map(_gains, loops), strict=True)
        phases, delays = zip(*(_turns(self.lines, each) for each in loops), strict=True)
        rejections = tuple(_rises(self.lines, np.abs(each)) for each in own.T)
        return ResponseMargins(np.abs(own), float(peaks[place]), float(self.lines[place]), lows, gains, phases, delays, rejections)


def _gains(own: Array) -> tuple[float, float]:
    """Nearest factors below and above 1 at which L crosses -1/k."""
    (real,) = _at_crossings(np.imag(own), np.real(own))
    factors = -1.0 / real[real < 0.0]
    return float(np.max(factors[factors < 1.0], initial=0.0)), float(np.min(factors[factors > 1.0], initial=np.inf))


def _turns(lines: Array, own: Array) -> tuple[float, float]:
    """Smallest phase [rad] of either sign, and delay [s], that move L with |L| = 1 to -1."""
    between, frequencies = _at_crossings(np.log(np.maximum(np.abs(own), _NOTHING)), own, lines)
    delays = np.mod(np.angle(-between), 2.0 * np.pi) / (2.0 * np.pi * frequencies)
    return float(np.min(np.abs(np.angle(-between)), initial=np.inf)), float(np.min(delays, initial=np.inf))


def _at_crossings(values: Array, *curves: Array) -> list[Array]:
    """Curves where values change sign, interpolated linearly."""
    places = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    share = values[places] / (values[places] - values[places + 1])
    return [each[places] * (1.0 - share) + each[places + 1] * share for each in curves]


def _rises(lines: Array, sizes: Array) -> float:
    """First upward crossing of |S_ii| = 1; NaN without one."""
    places = np.flatnonzero((sizes[:-1] < 1.0) & (sizes[1:] >= 1.0))
    if not len(places):
        return float("nan")
    ends = slice(int(places[0]), int(places[0]) + 2)
    return float(np.exp(np.interp(0.0, np.log(sizes[ends]), np.log(lines[ends]))))
