"""One loop's numbers by least squares: margins, rejection, settling as bounds that count where they are passed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import TypeAlias

import numpy as np

from flexstage.base.number import Array
from flexstage.control.tuning.shape import Shape

_BAND = 0.018
"""Within which a step is settled, a tenth less than the 2 % that are shown."""
STIFF, _SHARE, _STEPS = 30.0, 0.1, 1.0
_KEPT = 0.01
_BELOW = 0.985
"""What |S| is kept below where disturbances are to be rejected."""
_SAMPLES = 512
_LONGEST = 0.7
_DAMPINGS = (1e-6, 1e6)


@dataclass(frozen=True)
class Bounds:
    """What a loop has to keep: |S| below 1 up to `rejection` [Hz], steps within 2 % after `settling` [s], `overshoot` of them."""

    rejection: float
    settling: float
    overshoot: float


@dataclass(frozen=True, eq=False)
class OneLoop:
    """A loop as the others leave it: C times its `plants` (v, f) is its open loop, S = 1/(1 + C g), at `frequencies` (v, f) [Hz].

    `limits` (v,) are those of |S|. `slow` (w, h) are plants at the even frequencies `lines` (h,) [Hz] of steps, from 0 to half the rate;
    `disturbed` and `heard` (f,) are the mean squares that S and T of the first plant leave of the floor and of the gauges.
    """

    shape: Shape
    frequencies: Array
    plants: Array
    limits: Array
    lines: Array
    slow: Array
    disturbed: Array
    heard: Array

    @property
    def interval(self) -> float:
        """Time between samples of steps [s]."""
        return 0.5 / float(self.lines[-1])

    def sensitivities(self, point: Array) -> Array:
        """S (v, f)."""
        return 1.0 / (1.0 + self.plants * self.shape.response(point, self.frequencies)[0])

    def steps(self, point: Array) -> Array:
        """Answers (w, n) to a step, without the slowest that a period of them does not hold."""
        return _steps(_following(self.slow[:, 1:] * self.shape.response(point, self.lines[1:])[0], 1.0))

    def noise(self, point: Array) -> float:
        """Mean square at rest."""
        own = self.sensitivities(point)[0]
        return float(np.sum(self.disturbed * np.abs(own) ** 2 + self.heard * np.abs(1.0 - own) ** 2))


def encircles_nothing(returned: Array) -> Array:
    """Whether curves (..., f) of 1 + L of stable plants and controllers that integrate encircle 0 nowhere: Nyquist's criterion."""
    return np.abs(np.unwrap(np.angle(returned), axis=-1)[..., -1]) < 2.0


def _following(loops: Array, at_rest: float) -> Array:
    """T = L/(1 + L) (..., h), its value at rest before it."""
    return np.concatenate([np.full((*loops.shape[:-1], 1), at_rest), loops / (1.0 + loops)], axis=-1)


def _steps(following: Array) -> Array:
    return np.cumsum(np.fft.irfft(following, axis=-1), axis=-1)


def fit(loop: OneLoop, start: Array, bounds: Bounds, quiet: float, tries: int = 20) -> tuple[Array, float]:
    """The point near a stable start that keeps the bounds, or passes them least, and by how much at worst (relative).

    Of points that keep them the one of least noise, `quiet` being the weight of its rms over that of the start. Levenberg and Marquardt's
    rule on what passes the bounds; a step to an unstable loop is not taken.
    """
    found = Misfit(loop, bounds, quiet / max(np.sqrt(loop.noise(start)), 1e-300))
    low, high = loop.shape.bounds(start)
    point = descend(found.at, start, low, high, tries)
    return point, found.passed(point)


Squares: TypeAlias = tuple[float, Array, Array]
"""Half a sum of squares, its gradient (p,), and Gauss and Newton's curvature (p, p)."""


def descend(at: Callable[[Array], Squares | None], start: Array, low: Array, high: Array, tries: int) -> Array:
    """The point between bounds to which Levenberg and Marquardt's rule comes; where `at` gives none (unstable) it does not go.

    >>> bowl = lambda point: (0.5 * float(point @ point), point, np.eye(1))
    >>> found = descend(bowl, np.array([2.0]), np.array([-5.0]), np.array([5.0]), 20)
    >>> abs(found.round(3)).tolist()
    [0.0]
    """
    point, damping = np.clip(start, low, high), 1e-2
    here = at(point)
    if here is None:
        return start
    for _ in range(tries):
        cost, gradient, curvature = here
        free = ~((point <= low) & (gradient > 0.0) | (point >= high) & (gradient < 0.0))
        step = np.zeros(len(point))
        inner = curvature[np.ix_(free, free)]
        step[free] = -np.linalg.solve(inner + damping * np.diag(np.diag(inner) + 1e-9), gradient[free])
        moved = np.clip(point + step * min(1.0, _LONGEST / max(np.max(np.abs(step)), 1e-300)), low, high)
        there = at(moved)
        if there is None or there[0] >= cost:
            damping *= 8.0
            if damping >= _DAMPINGS[1]:
                break
            continue
        point, here, damping = moved, there, max(damping / 5.0, _DAMPINGS[0])
        if cost - there[0] < 1e-6 * cost:
            break
    return point


def sum_squares(terms: Iterable[tuple[Array, Array]], size: int) -> Squares:
    """Residuals (r,) with their derivatives (p, r), summed up."""
    cost, gradient, curvature = 0.0, np.zeros(size), np.zeros((size, size))
    for values, changes in terms:
        cost += 0.5 * float(values @ values)
        gradient += changes @ values
        curvature += changes @ changes.T
    return cost, gradient, curvature


@dataclass(frozen=True, eq=False)
class Misfit:
    """What passes the bounds of one loop, squared, with its derivatives."""

    loop: OneLoop
    bounds: Bounds
    quiet: float

    def at(self, point: Array) -> Squares | None:
        """The sum of squares; `None` where a plant is unstable."""
        terms = self.terms(point)
        return None if terms is None else sum_squares(terms, len(point))

    def terms(self, point: Array) -> Iterator[tuple[Array, Array]] | None:
        """Residuals and their derivatives; `None` where a plant is unstable."""
        one = self.loop
        value, slopes = one.shape.response(point, one.frequencies)
        own = 1.0 / (1.0 + one.plants * value)
        if not np.all(encircles_nothing(1.0 / own)):
            return None
        slow_value, slow_slopes = one.shape.response(point, one.lines[1:])
        following = _following(one.slow[:, 1:] * slow_value, 1.0)
        return chain(self.peaks(own, slopes), self.rest(own, slopes, following, slow_slopes[:, None, :]))

    def rest(self, own: Array, slopes: Array, following: Array, slow_slopes: Array) -> Iterator[tuple[Array, Array]]:
        """All but peaks of S, from S (v, f) and T (w, h) of the loop; dS = -S T slopes, slopes (p, v, f) and (p, w, h - 1)."""
        near = (self.loop.frequencies[0] <= self.bounds.rejection) & (np.abs(own[0]) > _BELOW)
        yield _over(own[0, near], slopes[:, 0, near], np.full(int(np.sum(near)), _BELOW))
        yield self._noise(own[0], slopes[:, 0])
        yield from self._settling(following, slow_slopes)

    def peaks(self, own: Array, slopes: Array) -> Iterator[tuple[Array, Array]]:
        """|S| above its limits."""
        limits = np.broadcast_to(self.loop.limits[:, None], own.shape)
        over = np.abs(own) > limits
        yield _over(own[over], slopes[:, over], limits[over])

    def passed(self, point: Array, *, sized: bool = True) -> float:
        """The largest relative excess over a bound, infinite for an unstable loop."""
        own = self.loop.sensitivities(point)
        if sized and not np.all(encircles_nothing(1.0 / own)):
            return np.inf
        sizes, steps = np.abs(own), self.loop.steps(point)
        below, late = self.loop.frequencies[0] <= self.bounds.rejection, self._late(steps.shape[1])
        return float(
            max(
                np.max(sizes / self.loop.limits[:, None]) - 1.0 if sized else 0.0,
                np.max(sizes[0, below], initial=0.0) - _BELOW,
                _SHARE * (np.max(np.abs(steps[:, late] - 1.0), initial=0.0) / _BAND - 1.0),
                np.max(steps) - 1.0 - self.bounds.overshoot,
            )
        )

    def _late(self, count: int) -> Array:
        return self.loop.interval * np.arange(count) >= self.bounds.settling

    def _noise(self, own: Array, slopes: Array) -> tuple[Array, Array]:
        """The rms at rest, one number: dS = -S T dlnC, dT = S T dlnC."""
        one, rest = self.loop, 1.0 - own
        rms = np.sqrt(max(float(np.sum(one.disturbed * np.abs(own) ** 2 + one.heard * np.abs(rest) ** 2)), 1e-300))
        change = np.real((one.heard * np.conj(rest) - one.disturbed * np.conj(own)) * own * rest * slopes).sum(axis=-1) / rms
        return np.array([self.quiet * rms]), self.quiet * change[:, None]

    def _settling(self, following: Array, slopes: Array) -> Iterator[tuple[Array, Array]]:
        """Of steps, what is outside its band late, and above the overshoot."""
        steps = _steps(following)
        every = max(1, steps.shape[1] // _SAMPLES)
        off, late = steps[:, ::every] - 1.0, self._late(steps.shape[1])[::every]
        outside, above = late & (np.abs(off) > _BAND), off > self.bounds.overshoot
        if not np.any(outside) and not np.any(above):
            return
        spectra = (following * (1.0 - following))[:, 1:] * slopes
        moved = _steps(np.pad(spectra, ((0, 0), (0, 0), (1, 0))))[..., ::every]
        side = np.sign(off[outside])
        yield _STEPS * (side * off[outside] / _BAND - 1.0), _STEPS * moved[:, outside] * side / _BAND
        yield STIFF * (off[above] - self.bounds.overshoot), STIFF * moved[:, above]


def _over(own: Array, slopes: Array, limits: Array) -> tuple[Array, Array]:
    """Values of |S| (r,) above limits, and d|S| = -Re(T dlnC) |S|."""
    size = np.abs(own) / limits
    return STIFF * (size - 1.0), -STIFF * np.real((1.0 - own) * slopes) * size


def keeps(passed: float) -> bool:
    """Whether bounds are kept, within what a grid of frequencies lets one see."""
    return passed <= _KEPT
