"""Growth of the noise of measured responses with their magnitude, from the scatter of neighbouring frequency lines."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array

_LINES, _TERMS = 9, 3
_CERTAIN = 40.0
"""Twice the log-likelihood gain for significant growth: for one parameter the false-alarm rate is 1e-9."""
_RATIOS = np.geomspace(1e-6, 1e6, 121)


def noise_growth(frequencies: Array, responses: Array) -> Array:
    """Estimate the growth factor g (p,) of every output's noise from responses H (f, p, m); an insignificant g is set to zero.

    The noise variance of an output is modelled as a (1 + g |H|^2) with a constant a. Amplitude steps of a shaker, ranges of an analyser and
    files with few digits cause errors proportional to the response. To estimate the variance at a frequency line, a rational function is
    fitted to nine lines. The function has a numerator of order two, and a denominator of order one, common to all responses (McKelvey &
    Guerin 2012). The residual of the fit has six complex degrees of freedom. The factor g is the maximum-likelihood estimate from the
    variances at all lines. The method needs no modal model; therefore a mode that is missing in a model is not mistaken for noise.

    >>> lines, draw = np.linspace(9.0, 11.0, 400), np.random.default_rng(0).standard_normal((2, 400, 1, 1))
    >>> one, noise = 1.0 / (1j * (lines - 10.0) + 0.1)[:, None, None], 0.003 * (draw[0] + 1j * draw[1])
    >>> bool(noise_growth(lines, one + noise)[0] == 0.0), bool(noise_growth(lines, one * (1.0 + noise))[0] > 10.0)
    (True, True)
    """
    if len(frequencies) < 2 * _LINES:
        return np.zeros(responses.shape[1])
    variance, power = _local_variance(frequencies, responses)
    return np.array([_growth(variance[:, output].ravel(), power[:, output].ravel()) for output in range(responses.shape[1])])


def _local_variance(frequencies: Array, responses: Array) -> tuple[Array, Array]:
    """Variance and mean power (w, p, m) of each nine neighbouring lines."""
    windows = np.lib.stride_tricks.sliding_window_view
    near = windows(frequencies, _LINES)
    x = (near - np.mean(near, axis=1, keepdims=True)) / (0.5 * (near[:, -1:] - near[:, :1]))
    every = np.moveaxis(windows(responses.reshape(len(responses), -1), _LINES, axis=0), 2, 1)
    basis = np.linalg.qr(x[:, :, None] ** np.arange(_TERMS))[0]
    turned = _beside(basis, x[:, :, None] * every)
    left = _beside(basis, every)
    size = np.mean(np.abs(every) ** 2, axis=1)
    weights = 1.0 / np.maximum(size, 1e-300)[:, None, :]
    slope = -np.sum(np.conj(turned) * left * weights, axis=(1, 2)) / np.maximum(np.sum(np.abs(turned) ** 2 * weights, axis=(1, 2)), 1e-300)
    denominator = 1.0 + slope[:, None] * x
    rest = np.sum(np.abs(left + slope[:, None, None] * turned) ** 2, axis=1)
    free = (_LINES - _TERMS) * np.mean(np.abs(denominator) ** 2, axis=1)
    shape = len(near), *responses.shape[1:]
    return (rest / free[:, None]).reshape(shape), size.reshape(shape)


def _beside(basis: Array, values: Array) -> Array:
    """Residual of the values (w, k, q) after polynomials."""
    return values - basis @ (np.swapaxes(basis, 1, 2) @ values)


def _growth(variance: Array, power: Array) -> float:
    middle = float(np.median(power))
    kept = (variance > 0.0) & (power > 0.0)
    if not middle or np.sum(kept) < _LINES:
        return 0.0
    variance, power = variance[kept], power[kept]
    free = (_LINES - _TERMS) * len(variance) / _LINES  # windows overlap: one in nine is independent

    def unlikely(ratio: float) -> float:
        grown = 1.0 + ratio / middle * power
        return free * float(np.log(np.mean(variance / grown)) + np.mean(np.log(grown)))

    found = np.array([unlikely(each) for each in _RATIOS])
    best = int(np.argmin(found))
    return float(_RATIOS[best] / middle) if 2.0 * (unlikely(0.0) - found[best]) > _CERTAIN else 0.0
