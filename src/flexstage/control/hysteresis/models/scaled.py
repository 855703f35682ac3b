"""Hysteresis of one stack, scaled to other stacks of its type: the same loop over other voltages and strokes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.control.hysteresis.models.envelope import Envelope
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.hysteresis.models.shape import Range, major_loop


def scale_to_stacks(model: PrandtlIshlinskii, volts: Range, low: Array, high: Array, stroke: Array) -> PrandtlIshlinskii:
    """Scale a one-axis model with the voltage range `volts` to n stacks with other voltage ranges and strokes, but loops of the same shape.

    The stacks have the voltage ranges `low` to `high` (n,) [V] and the full `stroke` (n,) [m].

    Only the knots of the envelope before the plays and the values of the envelope after the plays change; thresholds and weights do not. A
    stack's full stroke is the stroke of its settled loop, measured from the loop's lower end. Raises `DesignError` for a model of several
    axes, and for invalid ranges and strokes.

    >>> model = PrandtlIshlinskii([0.0, 100.0], [1e-7, 5e-8])
    >>> two = scale_to_stacks(model, (0.0, 1000.0), np.array([0.0, -100.0]), np.array([1000.0, 400.0]), np.array([150e-6, 30e-6]))
    >>> loops = [major_loop(two, (low, high)) for low, high in ((0.0, 1000.0), (-100.0, 400.0))]
    >>> [(round(float(loop.stroke[axis]) * 1e6, 6), round(float(loop.width[axis]), 6)) for axis, loop in enumerate(loops)]
    [(150.0, 0.071429), (30.0, 0.071429)]
    """
    if model.axes != 1:
        raise refuse("hysteresis", f"wrong number of axes (got {model.axes}, expected 1)", "Scale the model of one stack")
    require(_findings(volts, low, high, stroke))
    loop = major_loop(model, volts)
    stretch = (high - low) / (volts[1] - volts[0])
    growth = stroke / loop.stroke[0]
    axes = len(stretch)
    before = Envelope(low[:, None] + stretch[:, None] * (model.before.knots - volts[0]), np.repeat(model.before.values, axes, axis=0))
    after = Envelope(np.repeat(model.after.knots, axes, axis=0), growth[:, None] * (model.after.values - loop.up[0]))
    return PrandtlIshlinskii(np.repeat(model.thresholds, axes, axis=0), np.repeat(model.weights, axes, axis=0), before, after)


def _findings(volts: Range, *stacks: Array) -> Iterator[Finding]:
    if not volts[0] < volts[1]:
        yield Finding("volts", f"no range (got {volts[0]:g} V to {volts[1]:g} V)", "Use the lower voltage first")
    for axis, (low, high, stroke) in enumerate(zip(*stacks, strict=True)):
        if not (low < high and stroke > 0.0):
            what = f"invalid range or stroke (got {low:g} V to {high:g} V, {stroke:g} m)"
            yield Finding(f"stack {axis}", what, "Use ascending volts and a positive stroke")
