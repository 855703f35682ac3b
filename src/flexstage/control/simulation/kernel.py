"""What is not linear in a sample, in place: rounding, limits of amplifiers, the inverse of a hysteresis."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexstage.base.number import Array
from flexstage.control.hysteresis.models.inverse import inverse
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.simulation.machine import Amplifiers

Kernel = Callable[[Array, Array], Array]
"""Takes numbers and a place for the result, which it returns."""


def rounder(steps: Array) -> Kernel | None:
    """Rounding of numbers counted in steps, half to even; those without a step (0) pass; None where there is nothing to do.

    >>> rounder(np.array([0.0, 1.0]))(np.array([0.3, 1.7]), np.empty(2)).tolist()
    [0.3, 2.0]
    """
    coarse = steps > 0.0
    if not np.any(coarse):
        return None
    if np.all(coarse):
        return np.rint
    numbers = np.flatnonzero(coarse)

    def round_some(values: Array, out: Array) -> Array:
        np.copyto(out, values)
        out[numbers] = np.rint(values[numbers])
        return out

    return round_some


def reading_hold(reach: Array) -> Callable[[Array, Array], Array]:
    """Readings that are taken: in place of one that is no finite number or beyond its reach stands the one taken last.

    >>> hold = reading_hold(np.array([2.0, 2.0, 2.0]))
    >>> hold(np.array([1.5, np.nan, 3.0]), np.array([0.1, 0.2, 0.3])).tolist()
    [1.5, 0.2, 0.3]
    """
    size, good = np.empty(len(reach)), np.empty(len(reach), dtype=bool)

    def hold(readings: Array, last: Array) -> Array:
        if not np.less_equal(np.abs(readings, out=size), reach, out=good).all():
            np.copyto(readings, last, where=~good)
        return readings

    return hold


def converter(steps: Array) -> Kernel | None:
    """Rounding to steps (0: none); None where there is nothing to do.

    >>> converter(np.array([0.0, 0.5]))(np.array([0.3, 1.7]), np.empty(2)).tolist()
    [0.3, 1.5]
    """
    rounded = rounder(steps)
    if rounded is None:
        return None
    scale = np.where(steps > 0.0, steps, 1.0)

    def convert(values: Array, out: Array) -> Array:
        np.divide(values, scale, out=out)
        rounded(out, out)
        return np.multiply(out, scale, out=out)

    return convert


def limiter(amplifiers: Amplifiers, step: float) -> Callable[[Array, Array, Array], Array]:
    """Limits of range, then of speed: takes the wanted strokes, the last ones given and a place for the next.

    >>> one = {name: np.array([value]) for name, value in {"step": 0.0, "gain": 1.0, "bias": 0.0}.items()}
    >>> limit = limiter(Amplifiers(low=np.array([-5.0]), high=np.array([5.0]), slew=np.array([10.0]), **one), 0.1)
    >>> limit(np.array([9.0]), np.array([0.0]), np.empty(1)).tolist(), limit(np.array([9.0]), np.array([4.5]), np.empty(1)).tolist()
    ([1.0], [5.0])
    """
    low, high, most = amplifiers.low, amplifiers.high, amplifiers.slew * step
    reach = np.empty(len(low))

    def limit_range(wanted: Array, last: Array, out: Array) -> Array:  # noqa: ARG001 one form for both
        np.minimum(wanted, high, out=out)
        return np.maximum(out, low, out=out)

    def limit_speed(wanted: Array, last: Array, out: Array) -> Array:
        np.minimum(wanted, high, out=out)
        np.maximum(out, low, out=out)
        np.minimum(out, np.add(last, most, out=reach), out=out)
        return np.maximum(out, np.subtract(last, most, out=reach), out=out)

    return limit_speed if np.any(np.isfinite(most)) else limit_range


class Compensator:
    """The inverse of a Prandtl-Ishlinskii model that knows what was applied.

    `volts` says which volts make a wanted stroke from where the model stands; `move_to` moves the model to the volts that were given, be
    they limited or not. So the inverse does not lose the plant behind a limit. With plays z of the model, z' of its inverse and the
    partial sums P_j of weights p: z'_j = P_j z_j + sum_{i>j} p_i z_i (see `inverse_state`).
    """

    __slots__ = ("_after", "_before", "_bound", "_effective", "_entry", "_exit", "_inverse", "_model", "_partial", "_plays", "_turned")

    def __init__(self, model: PrandtlIshlinskii, bias: Array) -> None:
        self._model, self._inverse = model, inverse(model)
        shape = (model.axes,)
        self._entry = self._inverse.before.function(shape)
        self._exit = self._inverse.after.function(shape)
        self._before = model.before.function(shape)
        self._plays = np.array(model.start(bias))
        self._partial = np.cumsum(model.weights, axis=1)
        self._turned, self._bound, self._after = (np.empty_like(self._plays) for _ in range(3))
        self._effective = np.empty(shape)

    def volts(self, wanted: Array, out: Array) -> Array:
        """Volts (axes,) that make the strokes `wanted` (axes,) of the model; it stays where it is."""
        plays, bound, thresholds = self._turned, self._bound, self._inverse.thresholds
        np.multiply(self._model.weights, self._plays, out=bound)
        np.add.accumulate(bound[:, :0:-1], axis=1, out=self._after[:, -2::-1])
        np.multiply(self._partial, self._plays, out=plays)
        np.add(plays[:, :-1], self._after[:, :-1], out=plays[:, :-1])
        effective = self._entry(wanted, self._effective)[:, None]
        np.minimum(np.add(effective, thresholds, out=bound), plays, out=plays)
        np.maximum(np.subtract(effective, thresholds, out=bound), plays, out=plays)
        np.vecdot(self._inverse.weights, plays, out=self._effective)
        return self._exit(self._effective, out)

    def move_to(self, volts: Array) -> None:
        """Move the model to the volts (axes,) that were given."""
        plays, bound, thresholds = self._plays, self._bound, self._model.thresholds
        effective = self._before(volts, self._effective)[:, None]
        np.minimum(np.add(effective, thresholds, out=bound), plays, out=plays)
        np.maximum(np.subtract(effective, thresholds, out=bound), plays, out=plays)
