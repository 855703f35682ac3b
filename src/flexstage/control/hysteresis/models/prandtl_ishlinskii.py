"""The generalised Prandtl-Ishlinskii model: parallel plays between two envelopes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.control.hysteresis.models.envelope import IDENTITY, Envelope, freeze_rows
from flexstage.control.hysteresis.models.protocol import Hysteresis


@dataclass(frozen=True, eq=False)
class PrandtlIshlinskii(Hysteresis):
    """Prandtl-Ishlinskii hysteresis y = b( sum_i p_i F_{r_i}[a(x)] ), with plays F between the envelopes a and b.

    r_i are the thresholds of the plays, p_i their weights. For each axis, one sample is computed in this order (also in generated code):

        u   = a(x)
        z_i = max(u - r_i, min(u + r_i, z_i))     for every i, z_i the state
        y   = b(sum_i p_i z_i)

    The plays are by Kuhnen (Eur. J. Control 9, 2003, 407-418), the envelopes by Al Janaideh, Rakheja and Su (IEEE/ASME Trans. Mechatronics
    16, 2011, 734-744). `thresholds` (axes, n) ascend from r_0 = 0, the play without memory; `weights` are (axes, n). For a stack, x is the
    voltage, y the free stroke [m], thresholds are in V and weights in m/V. The envelope `before` (a) maps volts to volts; `after` (b) maps
    metres to metres and includes the gauge's offset. The inverse model (`inverse`) has the same form, but maps metres to volts. Initially
    all z_i = 0. With positive weights and ascending `before`, the stroke lags the voltage, and no loop generates energy.

    For a single axis the shape (n,) is also accepted. Raises `DesignError` for thresholds that do not ascend from 0, and different shapes.

    >>> model = PrandtlIshlinskii([0.0, 100.0], [1e-7, 5e-8])
    >>> (1e6 * model.run(np.array([0.0, 500.0, 400.0, 0.0]))).round(9).tolist()
    [0.0, 70.0, 60.0, 5.0]
    """

    thresholds: Array
    weights: Array
    before: Envelope = IDENTITY
    after: Envelope = IDENTITY

    def __post_init__(self) -> None:
        freeze_rows(self, "thresholds", "weights")
        require(_findings(self))

    @property
    def axes(self) -> int:
        """Number of actuators."""
        return len(self.thresholds)

    def start(self, value: Array) -> Array:
        """Return the n play outputs (axes, n), initially all 0, after a monotonic change of the input to a value (axes,)."""
        return self.step(np.zeros(1), np.broadcast_to(np.asarray(value, dtype=float), (self.axes,)))[0]

    def step(self, state: Array, value: Array) -> tuple[Array, Array]:
        """Return the next play outputs (axes, n) and the output (axes,) for the next input (axes,)."""
        effective = self.before.at(value)[:, None]
        plays = np.maximum(effective - self.thresholds, np.minimum(effective + self.thresholds, state))
        return plays, self.after.at(np.vecdot(self.weights, plays))


def _findings(model: PrandtlIshlinskii) -> Iterator[Finding]:
    thresholds, weights = model.thresholds, model.weights
    if thresholds.shape != weights.shape or thresholds.ndim != 2 or not thresholds.size:
        yield Finding(
            "hysteresis",
            f"different lengths (got thresholds {thresholds.shape}, weights {weights.shape})",
            "Use equal numbers of thresholds and weights, at least one",
        )
        return
    if not np.all(np.isfinite([thresholds, weights])):
        yield Finding("hysteresis", "a threshold or a weight is not finite", "Correct the values")
    for axis in np.flatnonzero(thresholds[:, 0] != 0.0):
        what = f"the first threshold of axis {axis} must be 0 (got {thresholds[axis, 0]:g})"
        yield Finding("thresholds", what, "Add a play of threshold 0 (no memory), of any weight")
    for axis, place in np.argwhere(np.diff(thresholds) <= 0.0):
        what = f"thresholds of axis {axis} must ascend (got {thresholds[axis, place + 1]:g} after {thresholds[axis, place]:g})"
        yield Finding("thresholds", what, "Sort the thresholds")
    for name in ("before", "after"):
        if (envelope := getattr(model, name)).axes not in (1, model.axes):
            yield Finding(
                f"envelope {name}",
                f"wrong number of axes (got {envelope.axes}, expected {model.axes}, like the plays)",
                "Use one envelope per axis, or one for all",
            )
