"""Effect of a window on a resonance: averaged windowed spectra show a smeared response, in closed form."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.spectral.cross_spectra import Window

_NEAR = 0.7
_TERMS = 16
SMEARING = (Window.BOXCAR, Window.HANN)
"""Windows with an effect that `WindowLeakage` can compute."""


@dataclass(frozen=True)
class WindowLeakage:
    """Effect of the `window` on estimated responses, for segments of length `seconds`.

    With white noise as input, the estimated impulse response is the true impulse response times r(t/T), with the window's autocorrelation r
    and the duration T of a segment. A fit accounts for the window: the fitted functions 1/(j f - p) of the frequency f, with poles p, are
    smeared in the same way.
    """

    window: Window
    seconds: float

    def functions(self, frequencies: Array, poles: Array) -> tuple[Array, Array]:
        """Compute the smeared functions 1/(j f - p) (..., k) and their derivatives with respect to p, for complex poles p (k,) in Hz.

        >>> sharp = 1 / (1j * 12.0 - (-1 + 10j))
        >>> smeared = WindowLeakage(Window.HANN, 1000.0).functions(np.array([12.0]), np.array([-1 + 10j]))[0]
        >>> bool(abs(smeared[0, 0] / sharp - 1.0) < 1e-3)
        True
        """
        scale = 2.0 * np.pi * self.seconds
        x = scale * (poles - 1j * np.asarray(frequencies)[..., None])
        return scale * self._transform(x, 0), scale**2 * self._transform(x, 1)

    def _transform(self, x: Array, order: int) -> Array:
        """Integral over 0..1 of t^order r(t) exp(x t)."""
        if self.window is Window.BOXCAR:
            return _ramp(x, order)
        above, below = x + 2j * np.pi, x - 2j * np.pi
        ramps = _ramp(x, order) * 2.0 / 3.0 + (_ramp(above, order) + _ramp(below, order)) / 6.0
        return ramps + (_step(above, order) - _step(below, order)) / (4j * np.pi)


def _step(x: Array, order: int) -> Array:
    """Integral over 0..1 of t^order exp(x t), orders 0 and 1."""
    far = np.where(np.abs(x) < _NEAR, 1.0, x)
    grown = np.exp(far)
    value = (grown - 1.0) / far if order == 0 else ((far - 1.0) * grown + 1.0) / far**2
    return np.where(np.abs(x) < _NEAR, _series(x, order, 0), value)


def _ramp(x: Array, order: int) -> Array:
    """Integral over 0..1 of t^order (1 - t) exp(x t), orders 0 and 1."""
    far = np.where(np.abs(x) < _NEAR, 1.0, x)
    grown = np.exp(far)
    value = (grown - 1.0 - far) / far**2 if order == 0 else (grown * (far - 2.0) + far + 2.0) / far**3
    return np.where(np.abs(x) < _NEAR, _series(x, order, 1), value)


def _series(x: Array, order: int, ramp: int) -> Array:
    """Sum over n of x^n / n! times the integral of t^(n + order) (1 - t)^ramp."""
    near = np.where(np.abs(x) < _NEAR, x, 0.0)
    total = np.zeros_like(near)
    for power in range(_TERMS):
        moment = 1.0 / (power + order + 1)
        if ramp:
            moment -= 1.0 / (power + order + 2)
        total = total + near**power * (moment / factorial(power))
    return total
