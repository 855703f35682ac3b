"""Protocol of hysteresis models in a loop: start state, step and simulation."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, Protocol

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array, freeze


class Hysteresis(Protocol):
    """Rate-independent hysteresis of `axes` actuators: the output depends on the order of the inputs, not on their times.

    One update per sample is exact if the input is monotonic between two samples, e.g. after a zero-order hold. Inputs and outputs have the
    shape (axes,); models of stacks map volts to free strokes [m]. Each model has its own form of state.
    """

    @property
    def axes(self) -> int:
        """Number of actuators."""
        ...

    def start(self, value: Array) -> Array:
        """Return the state after a monotonic change from the initial state to the input `value` (axes,)."""
        ...

    def step(self, state: Array, value: Array) -> tuple[Array, Array]:
        """Return the next state and the output (axes,) for the next input (axes,); `state` is not modified.

        >>> from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
        >>> (1e6 * PrandtlIshlinskii([0.0], [2e-7]).step(np.zeros((1, 1)), np.array([100.0]))[1]).round(9).tolist()
        [20.0]
        """
        ...

    def run(self, values: Array, state: Array | None = None) -> Array:
        """Simulate outputs for inputs (k, axes), or (k,) for a single actuator, from `state` (default: the initial state).

        Raises `DesignError` for inputs of another shape and for numbers that are not finite.

        >>> from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
        >>> (1e6 * PrandtlIshlinskii([0.0], [2e-7]).run(np.array([0.0, 100.0]))).round(9).tolist()
        [0.0, 20.0]
        """
        values = np.asarray(values, dtype=float)
        if values.shape[1:] != (self.axes,) and not (values.ndim == 1 and self.axes == 1):
            raise refuse("hysteresis", f"inputs have the wrong shape (got {values.shape})", f"Use (samples, {self.axes})")
        if not np.all(np.isfinite(values)):
            raise refuse("hysteresis", "an input is not finite", "Correct the inputs")
        rows = values.reshape(len(values), self.axes)
        found = np.empty_like(rows)
        for place, value in enumerate(rows):
            state, found[place] = self.step(self.start(value) if state is None else state, value)
        return found.reshape(values.shape)


def freeze_by_axis(model: Any) -> None:
    """Convert all fields of a dataclass to read-only arrays (axes,).

    >>> from flexstage.control.hysteresis.models.bouc_wen import BoucWen
    >>> BoucWen(np.array([1e-7, 2e-7]), 4e-8, 4e-3, 2e-3).lag.tolist()
    [4e-08, 4e-08]
    """
    names = [each.name for each in fields(model)]
    arrays = np.broadcast_arrays(*(np.array(getattr(model, name), dtype=float, ndmin=1) for name in names))
    for name, value in zip(names, arrays, strict=True):
        object.__setattr__(model, name, freeze(value))
