"""Least-squares fit of loop parameters; margins, rejection and settling are bounds that act only when violated."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np

from flexstage.base.number import Array
from flexstage.control.tuning.judge import first_rise
from flexstage.control.tuning.shape import Shape

BAND, _BAND_OFF = 0.0172, 0.0185
"""Settling band of steps, for the model and for shifted modes. It is below the reported 2 %, as a reserve for gauge rounding."""
STIFF, _SHARE, _STEPS = 30.0, 0.1, 1.0
"""Weights of the residuals: a bound violated by 3 % counts as much as all noise.

A step outside its band by a tenth of the band counts as much as a bound violated by 1 %.
"""
_KEPT = 0.01
"""Relative violation that counts as met, the resolution of the frequency grid."""
_BELOW = 0.985
"""Limit of |S| in the rejection band."""
_LESS = 0.95
"""Fraction of the rejection required for shifted modes."""
_SAMPLES = 512
"""Number of step samples with derivatives."""
_LONGEST = 0.7
"""Largest change of a parameter in one descent step, a factor of 2: beyond, the quadratic model is invalid."""
_DAMPINGS = (1e-6, 1e6)
_TREND, _STALLED, _NEAR_ENOUGH = 10, 0.97, 10.0
"""Tries over which the trend of a descent is evaluated; ratio above which it has stalled; factor on `enough` that it must reach."""
_STIFFER, _SOFTER = 4.0, 3.0
"""Limits of the Levenberg-Marquardt damping, and its factors of change."""


@dataclass(frozen=True)
class Bounds:
    """Bounds of a loop: sensitivity |S| < 1 up to `rejection` [Hz], steps within 2 % after `settling` [s], maximum `overshoot`.

    `noise` is the maximum rms noise in regulation. The first `plants` (1 or 2) plants must meet the rejection; for the second plant, 0.95
    of `rejection` is sufficient.
    """

    rejection: float
    settling: float
    overshoot: float
    noise: float = np.inf
    plants: int = 1


@dataclass(frozen=True, eq=False)
class OneLoop:
    """Single loop with the others closed: the `point` of a `shape` defines its controller C.

    `plants` (v, f) are the responses of v plants at their f `frequencies` (v, f) [Hz]; the product of C and a plant is the open loop. Step
    responses are computed from the evenly spaced frequencies `lines` (h,) [Hz], from 0 to half the sampling rate of the steps. `slow` (w, h
    - 1) are the responses of w plants at all `lines` except 0. The mean square of the noise is the sum of `disturbed` |S|^2, due to the
    floor, and `heard` |T|^2, due to the gauges, over the first plant's frequencies. S is the sensitivity, T = 1 - S the complementary
    sensitivity.
    """

    shape: Shape
    point: Array
    frequencies: Array
    plants: Array
    lines: Array
    slow: Array
    disturbed: Array
    heard: Array

    @cached_property
    def sensitivity(self) -> Array:
        """Sensitivity S (v, f) of v plants at f frequencies."""
        return 1.0 / (1.0 + self.plants * self.shape.value(self.point, self.frequencies))

    @cached_property
    def following(self) -> Array:
        """Complementary sensitivity T (w, h) of w plants at the frequencies `lines`; T is 1 at zero frequency."""
        loops = self.slow * self.shape.value(self.point, self.lines[1:])
        return np.concatenate([np.ones((len(loops), 1)), loops / (1.0 + loops)], axis=-1)

    @property
    def interval(self) -> float:
        """Time between samples of step responses [s]."""
        return 0.5 / float(self.lines[-1])

    @property
    def rejection(self) -> float:
        """First frequency [Hz] where the magnitude of the model's sensitivity rises through 1."""
        return first_rise(np.abs(self.sensitivity[0]), self.frequencies[0])

    @property
    def rms(self) -> float:
        """Rms noise in regulation."""
        return self._rms(self.sensitivity[0])

    @property
    def settling(self) -> float:
        """Settling time of the model's step [s], at least one sample."""
        outside = np.flatnonzero(np.abs(_steps(self.following)[0] - 1.0) > BAND)
        return self.interval * (1.0 + (float(outside[-1]) if len(outside) else 0.0))

    def _rms(self, own: Array) -> float:
        square = float(np.sum(self.disturbed * np.abs(own) ** 2 + self.heard * np.abs(1.0 - own) ** 2))
        return max(float(np.sqrt(square)), 1e-300)

    def misfits(
        self, bounds: Bounds, quiet: float, near: tuple[Array, Array], slow: tuple[Array, Callable[[], Array]]
    ) -> Iterator[tuple[Array, Array]]:
        """Yield the residuals and derivatives of all bounds except peaks of the sensitivity; `quiet` is the weight of noise.

        Slopes are the derivatives of the logarithm of the controller C with respect to its p parameters; multiplied by -S T, they are the
        derivatives of S. `near` contains the sensitivity S (n, f) of the n plants that must meet the rejection, and the slopes (p, n, f).
        `slow` contains the complementary sensitivity T (w, h) of w plants, and a function that returns the slopes (p, w, h - 1).
        """
        own, slopes = near
        above = self._rejected(bounds) & (np.abs(own) > _BELOW)
        yield _over(own[above], slopes[:, above])
        yield self._noise(bounds, quiet, own[0], slopes[:, 0])
        yield from self._settling(bounds, *slow)

    def excess(self, bounds: Bounds) -> float:
        """Compute the largest relative violation of a bound, except peaks of the sensitivity."""
        sizes, steps = np.abs(self.sensitivity[: bounds.plants]), _steps(self.following)
        below, late = self._rejected(bounds), self._late(bounds, steps.shape[1])
        return float(
            max(
                np.max(sizes[below], initial=0.0) - _BELOW,
                self.rms / bounds.noise - 1.0,
                _SHARE * (np.max((np.abs(steps - 1.0) / _bands(steps))[:, late], initial=0.0) - 1.0),
                np.max(steps) - 1.0 - bounds.overshoot,
            )
        )

    def _rejected(self, bounds: Bounds) -> Array:
        """Mask (n, f) of the rejection band."""
        count = bounds.plants
        return self.frequencies[:count] <= bounds.rejection * np.array([1.0, _LESS])[:count, None]

    def _late(self, bounds: Bounds, count: int) -> Array:
        return self.interval * np.arange(count) >= bounds.settling

    def _noise(self, bounds: Bounds, quiet: float, own: Array, slopes: Array) -> tuple[Array, Array]:
        """Rms noise in regulation, and its excess: dS = -S T dlnC, dT = S T dlnC."""
        rest, rms = 1.0 - own, self._rms(own)
        change = np.real((self.heard * np.conj(rest) - self.disturbed * np.conj(own)) * own * rest * slopes).sum(axis=-1) / rms
        over = rms / bounds.noise - 1.0
        if over <= 0.0:
            return np.array([quiet * rms]), quiet * change[:, None]
        return np.array([quiet * rms, STIFF * over]), np.stack([quiet * change, STIFF / bounds.noise * change], axis=-1)

    def _settling(self, bounds: Bounds, following: Array, slopes: Callable[[], Array]) -> Iterator[tuple[Array, Array]]:
        """Late step samples outside the band, and samples above the overshoot."""
        steps = _steps(following)
        every = max(1, steps.shape[1] // _SAMPLES)
        late = self._late(bounds, steps.shape[1])[every - 1 :: every]
        off = steps[:, every - 1 :: every] - 1.0
        bands = _bands(off)
        outside, above = late & (np.abs(off) > bands), off > bounds.overshoot
        if not np.any(outside) and not np.any(above):
            return
        moved = _summed((following * (1.0 - following))[:, 1:] * slopes(), every)
        side = np.sign(off[outside]) / bands[outside]
        yield _STEPS * (side * off[outside] - 1.0), _STEPS * moved[:, outside] * side
        yield STIFF * (off[above] - bounds.overshoot), STIFF * moved[:, above]


def _bands(steps: Array) -> Array:
    """Bands of steps (w, n), the model's first."""
    return np.where(np.arange(len(steps)) == 0, BAND, _BAND_OFF)[:, None] * np.ones(steps.shape)


def _steps(following: Array) -> Array:
    """Step responses (w, n), without the slowest part, longer than a period."""
    return np.cumsum(np.fft.irfft(following, axis=-1), axis=-1)


Squares: TypeAlias = tuple[float, Array, Array]
"""Half a sum of squares, its gradient (p,), and the Gauss-Newton curvature (p, p)."""


def descend(at: Callable[[Array], Squares | None], start: Array, within: tuple[Array, Array], tries: int, enough: float = 0.0) -> Array:
    """Minimise half a sum of squares by the Levenberg-Marquardt method, with parameters between the limits `within` (low, high).

    Points at which `at` returns None (unstable) are rejected. The search ends when half the sum of squares is at most `enough`, or
    decreases too slowly to reach `enough`.

    >>> bowl = lambda point: (0.5 * float(point @ point), point, np.eye(1))
    >>> found = descend(bowl, np.array([2.0]), (np.array([-5.0]), np.array([5.0])), 20)
    >>> abs(found.round(3)).tolist()
    [0.0]
    """
    low, high = within
    point, damping = np.clip(start, low, high), 1e-2
    here = at(point)
    if here is None:
        return start
    costs: list[float] = []
    for _ in range(tries):
        cost, gradient, curvature = here
        costs.append(cost)
        if cost <= enough or not _is_promising(costs, tries, enough):
            break
        free = ~((point <= low) & (gradient > 0.0) | (point >= high) & (gradient < 0.0))
        step = np.zeros(len(point))
        inner = curvature[np.ix_(free, free)]
        step[free] = -np.linalg.solve(inner + damping * np.diag(np.diag(inner) + 1e-9), gradient[free])
        moved = np.clip(point + step * min(1.0, _LONGEST / max(np.max(np.abs(step)), 1e-300)), low, high)
        there = at(moved)
        if there is None or there[0] >= cost:
            damping *= _STIFFER
            if damping >= _DAMPINGS[1]:
                break
            continue
        point, here, damping = moved, there, max(damping / _SOFTER, _DAMPINGS[0])
        if cost - there[0] < 1e-6 * cost:
            break
    return point


def _is_promising(costs: list[float], tries: int, enough: float) -> bool:
    """Whether half sums fall, and fast enough to come near `enough` by the last try."""
    if len(costs) <= _TREND:
        return True
    trend = costs[-1] / costs[-1 - _TREND]
    return trend < _STALLED and (not enough or costs[-1] * trend ** ((tries - len(costs)) / _TREND) < _NEAR_ENOUGH * enough)


def sum_squares(terms: Iterable[tuple[Array, Array]], size: int) -> Squares:
    """Return half the sum of squares, its gradient and its curvature from residuals (r,) and their derivatives (p, r) by p parameters."""
    cost, gradient, curvature = 0.0, np.zeros(size), np.zeros((size, size))
    for values, changes in terms:
        cost += 0.5 * float(values @ values)
        gradient += changes @ values
        curvature += changes @ changes.T
    return cost, gradient, curvature


def _summed(spectra: Array, every: int) -> Array:
    """Cumulative sums over time (..., n) for spectra (..., h), zero at rest, at every so-many-th sample, the last included.

    A sum is a division by 1 - exp(-i omega T); fewer samples are folded spectra.
    """
    half = spectra.shape[-1]
    turn = np.exp(1j * np.pi * np.arange(1, half + 1) / half)
    sums = spectra * (turn**every / (turn - 1.0))
    sums[..., -1] = sums[..., -1].real
    size = 2 * half // every
    folded = np.zeros((*spectra.shape[:-1], size // 2 + 1), complex)
    for number in range(every):
        places = np.arange(size // 2 + 1) + number * size
        inside = (places > 0) & (places <= half)
        folded[..., inside] += sums[..., places[inside] - 1]
        beyond = (places > half) & (places < 2 * half)
        folded[..., beyond] += np.conj(sums[..., 2 * half - places[beyond] - 1])
    found = np.fft.irfft(folded, n=size, axis=-1) / every
    return found - found[..., -1:]


def _over(own: Array, slopes: Array) -> tuple[Array, Array]:
    """Excess of |S| (r,) above its limit, and d|S| = -Re(T dlnC) |S|."""
    size = np.abs(own) / _BELOW
    return STIFF * (size - 1.0), -STIFF * np.real((1.0 - own) * slopes) * size


def keeps(passed: float) -> bool:
    """Whether the largest relative violation `passed` is within the resolution of the frequency grid, and thus negligible."""
    return passed <= _KEPT
