"""Poly-reference least-squares complex frequency-domain estimator (pLSCF): poles of increasing order from frequency responses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array

_SPAN = 1.0
"""Angle of the band on the unit circle, in units of pi: the remainder separates the band's two ends."""


@dataclass(frozen=True, eq=False)
class Poles:
    """Poles of one order: `values` (k,) in rad/s with Re < 0 and Im > 0; the rows of `participation` (k, m) have unit length."""

    order: int
    values: Array
    participation: Array

    @property
    def frequencies(self) -> Array:
        """Natural frequencies |pole|/(2 pi) in Hz."""
        return np.abs(self.values) / (2.0 * np.pi)

    @property
    def damping(self) -> Array:
        """Damping ratios -Re(pole)/|pole|."""
        return -np.real(self.values) / np.abs(self.values)


def lscf(frequencies: Array, responses: Array, weights: Array, orders: range) -> tuple[Poles, ...]:
    """Estimate the poles of every order from responses H (f, p, m) at `frequencies` in Hz, with weights (f, p) of the outputs.

    The model is the right matrix fraction H = B(z) A(z)^-1: B and A are matrix polynomials with complex coefficients in z = exp(s T), with
    the Laplace variable s. The period T is chosen so that the band covers half of the unit circle (Peeters, Van der Auweraer, Guillaume &
    Leuridan, Shock Vib. 11 (2004) 395). Phases of poles are unwrapped about the band's centre. The participation of a pole z_r is the left
    null vector w of A(z_r). Near z_r, A^-1 is proportional to v w^H / (z - z_r), with the right null vector v; every row of H is therefore
    a multiple of w^H. Returns only stable poles within the band.

    >>> lines = np.linspace(8.0, 12.0, 81)
    >>> one = 1.0 / (2j * np.pi * lines - (-1.0 + 2j * np.pi * 10.0))
    >>> found = lscf(lines, one[:, None, None], np.ones((81, 1)), range(2, 3))[0]
    >>> round(float(found.values[0].real), 2), round(float(found.values[0].imag / (2 * np.pi)), 3)
    (-1.0, 10.0)
    """
    step = (frequencies[-1] - frequencies[0]) * len(frequencies) / (len(frequencies) - 1)
    period = _SPAN / (2.0 * step)
    count = responses.shape[2]
    highest = max(orders)
    angles = _SPAN * np.pi * (frequencies - frequencies[0]) / step
    normal = [_products(angles, responses[:, output], weights[:, output], highest) for output in range(responses.shape[1])]
    found: list[Poles] = []
    for order in orders:
        size = order + 1
        reduced = np.sum([_reduce(*products, size) for products in normal], axis=0)
        found.append(_poles(reduced, order, count=count, low=frequencies[0], high=frequencies[-1], period=period))
    return tuple(found)


def _products(angles: Array, rows: Array, weight: Array, highest: int) -> tuple[Array, Array, Array]:
    """Lag sums of w^2, w^2 H and w^2 H^H H over the band: the normal equations are Toeplitz in the powers of z."""
    lines = len(rows)
    lags = np.exp(1j * np.outer(np.arange(-highest, highest + 1), angles))
    squared = weight**2
    power = squared[:, None, None] * np.conj(rows[:, :, None]) * rows[:, None, :]
    count = rows.shape[1]
    return lags @ squared, lags @ (squared[:, None] * rows), (lags @ power.reshape(lines, -1)).reshape(-1, count, count)


def _reduce(weight: Array, crossed: Array, power: Array, size: int) -> Array:
    """Schur complement T - S^H R^-1 S of one output: the numerator eliminated."""
    middle = (len(weight) - 1) // 2
    lag = middle + np.arange(size)[None, :] - np.arange(size)[:, None]
    count = crossed.shape[1]
    own, mixed = weight[lag], -crossed[lag].reshape(size, size * count)
    full = power[lag].transpose(0, 2, 1, 3).reshape(size * count, size * count)
    return full - np.conj(mixed.T) @ np.linalg.solve(own, mixed)


def _poles(reduced: Array, order: int, *, count: int, low: float, high: float, period: float) -> Poles:
    """Roots of det A with the coefficient of the lowest power fixed, which makes mathematical poles unstable."""
    rest = reduced[count:, count:]
    solved = -np.linalg.lstsq(rest, reduced[count:, :count], rcond=None)[0]
    coefficients = np.concatenate([np.eye(count), solved]).reshape(order + 1, count, count)
    # x = 1/z makes the fixed coefficient the leading one; A^T acts on the left null vectors of A
    companion = np.zeros((order * count, order * count), dtype=complex)
    companion[count:, :-count] = np.eye((order - 1) * count)
    companion[:count] = -np.concatenate([coefficients[power].T for power in range(1, order + 1)], axis=1)
    roots, vectors = np.linalg.eig(companion)
    return _physical_poles(1.0 / roots[roots != 0.0], vectors[-count:, roots != 0.0].T, order, low=low, high=high, period=period)


def _physical_poles(roots: Array, vectors: Array, order: int, *, low: float, high: float, period: float) -> Poles:
    middle = 0.5 * _SPAN * np.pi
    angle = np.angle(roots * np.exp(-1j * middle)) + middle
    values = np.log(np.abs(roots)) / period + 1j * (angle / period + 2.0 * np.pi * low)
    inside = (values.imag >= 2.0 * np.pi * low) & (values.imag <= 2.0 * np.pi * high)
    kept = np.flatnonzero((values.real < 0.0) & inside)
    kept = kept[np.argsort(values.imag[kept])]
    length = np.linalg.norm(vectors[kept], axis=1, keepdims=True)
    return Poles(order, values[kept], vectors[kept] / np.where(length > 0.0, length, 1.0))
