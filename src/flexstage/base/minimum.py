"""Zeros and minima of functions, without what else `scipy.optimize` imports, a fifth of a second."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from flexstage.base.binding import binding
from flexstage.base.number import Array

_GOLDEN = 0.5 * (5.0**0.5 - 1.0)
_ROUNDING = float(np.finfo(float).eps)
_DECREASE, _CURVATURE = 1e-4, 0.9
_STEPS, _HALVINGS = 200, 40

_Sloped: TypeAlias = Callable[[Array], tuple[float, Array]]
"""A function and its gradient (n,) at a place (n,)."""


def root(of: Callable[[float], float], low: float, high: float, *, within: float) -> float:
    """Where a function is 0 between two places at which its signs differ: `scipy.optimize.brentq` itself (Brent 1973).

    Raises `ValueError` where the signs are alike.

    >>> round(root(lambda x: x * x - 2.0, 0.0, 2.0, within=1e-12), 9)
    1.414213562
    """
    routine = binding("scipy.optimize._zeros", "scipy.optimize._zeros")._brentq  # noqa: SLF001 (what scipy calls)
    full, strict = False, True
    return float(routine(of, low, high, within, 4.0 * _ROUNDING, _STEPS, (), full, strict))


def lowest(of: Callable[[float], float], low: float, high: float, *, within: float) -> float:
    """A local minimum between two places by the golden section (Kiefer 1953): kinks slow it no more than curves.

    >>> round(lowest(lambda x: abs(x - 1.0), 0.0, 3.0, within=1e-6), 5)
    1.0
    """
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    before, behind = of(left), of(right)
    while high - low > within:
        if before <= behind:
            high, right, behind = right, left, before
            left = high - _GOLDEN * (high - low)
            before = of(left)
        else:
            low, left, before = left, right, behind
            right = low + _GOLDEN * (high - low)
            behind = of(right)
    return left if before <= behind else right


def descend(of: _Sloped, start: Array, *, within: float) -> tuple[Array, float]:
    """A local minimum (n,) and its value, from a start: BFGS, until no slope is above `within` or no step leads lower.

    Nocedal & Wright, Numerical Optimization (2006), algorithm 6.1; steps by bisection, which kinks do not stop (Lewis & Overton,
    Mathematical Programming 141 (2013) 135).

    >>> place, value = descend(lambda x: (float(x @ x - 2.0 * x[0]), 2.0 * x - [2.0, 0.0]), np.array([3.0, 4.0]), within=1e-9)
    >>> (place.round(9) + 0.0).tolist(), round(value, 9)
    ([1.0, 0.0], -1.0)
    """
    place, (value, slope), inverse = start, of(start), np.eye(len(start))
    for number in range(_STEPS):
        if np.max(np.abs(slope), initial=0.0) <= within:
            break
        direction = -inverse @ slope
        found = _step(of, place, direction, value, float(slope @ direction))
        if found is None:
            break
        length, value, after = found
        moved, turned = length * direction, after - slope
        place, slope = place + moved, after
        along = float(turned @ moved)
        if along > 0.0:
            inverse = (along / (turned @ turned)) * np.eye(len(start)) if number == 0 else inverse
            across = np.eye(len(start)) - np.outer(moved, turned) / along
            inverse = across @ inverse @ across.T + np.outer(moved, moved) / along
    return place, value


def _step(of: _Sloped, place: Array, direction: Array, value: float, fall: float) -> tuple[float, float, Array] | None:
    """A length that leads lower by a share of what the slope promises, to where it is less steep; its value and slope."""
    low, high, length = 0.0, np.inf, 1.0
    for _ in range(_HALVINGS):
        reached, slope = of(place + length * direction)
        if reached > value + _DECREASE * length * fall + _ROUNDING * abs(value):
            high = length
        elif slope @ direction < _CURVATURE * fall:
            low = length
        else:
            return length, reached, slope
        length = 2.0 * low if np.isinf(high) else 0.5 * (low + high)
    return None
