"""Input shapers: impulse sequences without residual vibration of a mode after a step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array


@dataclass(frozen=True, eq=False)
class Shaper:
    """Input shaper: a unit step becomes steps of `amplitudes` (k,), with sum 1, at `times` (k,) [s]."""

    times: Array
    amplitudes: Array

    def shape(self, poses: Array, step: float) -> Array:
        """Shape a path (n, f) that is at rest before its start, with samples every `step` [s].

        An impulse between two samples acts partly at each of the two samples.

        >>> half = Shaper(np.array([0.0, 0.2]), np.array([0.5, 0.5]))
        >>> half.shape(np.ones((4, 1)), 0.1).ravel().tolist()
        [0.5, 0.5, 1.0, 1.0]
        """
        found = np.zeros_like(poses)
        for time, amplitude in zip(self.times, self.amplitudes, strict=True):
            whole = int(time / step + 1e-9)
            late = time / step - whole
            for shift, share in ((whole, 1.0 - late), (whole + 1, late)):
                if share > 1e-9 and shift < len(poses):
                    found[shift:] += amplitude * share * poses[: len(poses) - shift]
        return found


def zv(frequency: float, damping: float) -> Shaper:
    """Construct a zero-vibration (ZV) shaper for a mode of undamped `frequency` [Hz] and `damping` ratio zeta.

    The impulses 1/(1+K) and K/(1+K) are half a damped period apart, with K = exp(-zeta pi / (1 - zeta^2)^(1/2)) (Singer & Seering, Journal
    of Dynamic Systems, Measurement, and Control 112 (1990) 76). Raises `DesignError` for invalid numbers.

    >>> zv(50.0, 0.0).times.tolist(), zv(50.0, 0.0).amplitudes.tolist()
    ([0.0, 0.01], [0.5, 0.5])
    """
    return _shaper(frequency, damping, 1)


def zvd(frequency: float, damping: float) -> Shaper:
    """Construct a zero-vibration-derivative (ZVD) shaper: impulses (1, 2K, K^2) / (1+K)^2, half a damped period apart.

    K is defined as in `zv`. The residual vibration is proportional to the square of the frequency error.

    >>> zvd(50.0, 0.0).amplitudes.tolist()
    [0.25, 0.5, 0.25]
    """
    return _shaper(frequency, damping, 2)


def _shaper(frequency: float, damping: float, order: int) -> Shaper:
    """Impulses (1 + K z)^n / (1 + K)^n, with z half a damped period late."""
    found = [] if frequency > 0.0 else [Finding("shaper", f"frequency must be positive (got {frequency:g} Hz)", "Use e.g. 100 Hz")]
    if not 0.0 <= damping < 1.0:
        found.append(
            Finding(
                "shaper",
                f"damping out of range (got {damping:g}, expected 0 or more and less than 1)",
                "Use a ratio below 1: an overdamped mode needs no shaper",
            )
        )
    require(found)
    root = float(np.sqrt(1.0 - damping**2))
    factor = float(np.exp(-damping * np.pi / root))
    amplitudes = np.array([[1.0, factor], [1.0, 2.0 * factor, factor**2]][order - 1]) / (1.0 + factor) ** order
    return Shaper(0.5 / (frequency * root) * np.arange(order + 1.0), amplitudes)
