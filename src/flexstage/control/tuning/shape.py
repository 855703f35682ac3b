"""Law and notches of a loop as a parameter point, with the response's derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.control.controllers.notch import Notch
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.pid import PID

_GAIN = 1e4
_MOVED = 2.5
"""Factors by which gains and notch frequencies may move from a start."""
_DEEPEST, _NARROWEST, _WIDEST = 1e-3, 0.03, 6.0
_BELOW = 0.45
"""Lowest depth and damping of notches, largest damping, and highest frequency over the sampling rate, for Tustin's rule."""


@dataclass(frozen=True)
class Shape:
    """Shape of a loop's controller: PI, or PID with its derivative filtered at `corner` [Hz]; `count` notches, sampled every `step` [s].

    A point contains the logarithms of the proportional gain k_p, of k_i/k_p [1/s] with the integral gain k_i and, for a PID, of k_d/k_p [s]
    with the derivative gain k_d. The logarithms of each notch's frequency [Hz], depth and damping follow. `slowest` [1/s] is the lower
    limit of k_i/k_p; it keeps the zero and the integrator's tail from becoming too slow.
    """

    count: int
    step: float | None
    corner: float | None = None
    slowest: float = 1e-6

    @property
    def gains(self) -> int:
        """Number of gain parameters."""
        return 2 if self.corner is None else 3

    def law(self, point: Array) -> PI | PID:
        """Return the control law of a parameter point."""
        proportional, *ratios = np.exp(point[: self.gains]).tolist()
        gains = [proportional * ratio for ratio in ratios]
        return PI(proportional, gains[0]) if self.corner is None else PID(proportional, gains[0], gains[1], self.corner)

    def notches(self, point: Array) -> tuple[Notch, ...]:
        """Return the notches of a parameter point."""
        return tuple(Notch(*map(float, np.exp(each))) for each in self._notch_points(point))

    def point(self, law: PI | PID, notches: tuple[Notch, ...]) -> Array:
        """Return the parameter point of a control law and its notches."""
        others = [law.integral, *([law.derivative] if isinstance(law, PID) else [])]
        gains = [law.proportional, *(each / law.proportional for each in others)]
        numbers = [number for each in notches for number in (each.frequency, each.depth, each.damping)]
        return np.log(np.maximum([*gains, *numbers], 1e-12))

    def bounds(self, start: Array) -> tuple[Array, Array]:
        """Return bounds (low, high) of points: notch frequencies stay near those of `start`, and below half the sampling rate."""
        low, high = start - np.log(_GAIN), start + np.log(_GAIN)
        low[1] = np.log(self.slowest)
        for number in range(self.count):
            at = self.gains + 3 * number
            highest = np.inf if self.step is None else np.log(_BELOW / self.step)
            low[at : at + 3] = start[at] - np.log(_MOVED), np.log(_DEEPEST), np.log(_NARROWEST)
            high[at : at + 3] = min(start[at] + np.log(_MOVED), highest), 0.0, np.log(_WIDEST)
        return low, high

    def response(self, point: Array, frequencies: Array) -> tuple[Array, Array]:
        """Compute the controller's response (f,), infinite at zero frequency, and its logarithm's derivatives (p, f) by the p parameters.

        >>> shape = Shape(1, 1e-4)
        >>> start = shape.point(PI(0.5, 100.0), (Notch(106.0, 0.1, 0.5),))
        >>> value, slopes = shape.response(start, np.array([30.0]))
        >>> moved, _ = shape.response(start + 1e-6 * np.eye(5)[3], np.array([30.0]))  # by the depth
        >>> bool(np.isclose(np.log(moved / value)[0] / 1e-6, slopes[3, 0], rtol=1e-5))
        True
        """
        turned, rate = self._turned(frequencies)
        value, parts = self._law(point, 1j * rate * turned)
        slopes = [part / value for part in parts]
        for frequency, depth, damping in np.exp(self._notch_points(point)):
            own, further = _notch(turned / self._turned(np.array([frequency]))[0], depth, damping)
            value, slopes = value * own, [*slopes, further[0] * self._warp(frequency), *further[1:]]
        return value, np.array(slopes)

    def value(self, point: Array, frequencies: Array) -> Array:
        """Compute the controller's response (f,) without derivatives."""
        turned, rate = self._turned(frequencies)
        value = self._law(point, 1j * rate * turned)[0]
        for frequency, depth, damping in np.exp(self._notch_points(point)):
            q = turned / self._turned(np.array([frequency]))[0]
            rest, below = 1.0 - q**2, 2j * damping * q
            value = value * ((rest + depth * below) / (rest + below))
        return value

    def _law(self, point: Array, s: Array) -> tuple[Array, list[Array]]:
        """Law response, and its derivatives by the gains' logarithms."""
        gains = np.exp(point[: self.gains])
        parts = [gains[0] * gains[1] / s]
        if self.corner is not None:
            parts.append(gains[0] * gains[2] * s / (1.0 + s / (2.0 * np.pi * self.corner)))
        whole = gains[0] + np.sum(parts, axis=0)
        return whole, [whole, *parts]

    def _notch_points(self, point: Array) -> Array:
        return np.reshape(point[self.gains :], (self.count, 3))

    def _turned(self, frequencies: Array) -> tuple[Array, float]:
        """Value tan(pi f T), and its scale to omega for Tustin's rule; omega itself without sampling."""
        if self.step is None:
            return 2.0 * np.pi * frequencies, 1.0
        return np.tan(np.pi * frequencies * self.step), 2.0 / self.step

    def _warp(self, frequency: float) -> float:
        """Derivative d ln q / d ln f of q = omega over a notch's, prewarped."""
        if self.step is None:
            return -1.0
        angle = 2.0 * np.pi * frequency * self.step
        return -angle / float(np.sin(angle))


def _notch(q: Array, depth: float, damping: float) -> tuple[Array, tuple[Array, Array, Array]]:
    """Notch N at q = omega/omega_n, and d ln N by ln q, ln depth and ln damping."""
    square, below = q**2, 2j * damping * q
    above, rest = depth * below, 1.0 - square
    zeros, poles = 1.0 / (rest + above), 1.0 / (rest + below)
    by_depth, by_pole = above * zeros, below * poles
    by_q = by_depth - by_pole - 2.0 * square * (zeros - poles)
    return (rest + above) * poles, (by_q, by_depth, by_depth - by_pole)
