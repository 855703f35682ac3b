"""The simulation itself: one sample after the other, in numpy."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated

import numpy as np

from flexstage.base.arguments import GAPS, check_arguments
from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.control.simulation.actuation import Actuation
from flexstage.control.simulation.disturbances import Inflow, inflow
from flexstage.control.simulation.fused import Fused, Parts, Row, fuse, parts
from flexstage.control.simulation.kernel import reading_hold, rounder
from flexstage.control.simulation.machine import Machine
from flexstage.control.simulation.result import Series, Simulated, simulation_result

BLOCK = 1024
_NONE: Mapping[str, Array] = {}


@check_arguments
def simulate(given: Machine, reference: Array, disturbances: Mapping[str, Annotated[Array, GAPS]] = _NONE) -> Simulated:
    """The loop's answer to a reference (n, f) [m, rad] and disturbances (n,) each, from rest, sample by sample.

    `disturbances` are `ground.<c>`, `platform.fx` ... (further inputs of the plant), `noise.<gauge>` [m] added to a reading before it is
    rounded (not finite: that reading is lost), `noise.<actuator>` [m] added to a free stroke. Nothing here is random (see `noises`).
    Between samples the plant is exact for strokes and wrenches that are held and a ground that goes straight (see `zero_order_hold`): there
    is no error of integration. Raises `DesignError` for unknown names, lengths that differ, and where numbers grow beyond bounds.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> found = simulate(machine(example.plant, example.controller), np.full((2000, 1), 1e-6))
    >>> round(float(found.pose[-1, 0]) * 1e9, 2)  # an integrator leaves no error: 1000 nm
    1000.0
    """
    linear = parts(given)
    form, entering = fuse(given, linear), inflow(given, reference, disturbances)
    row, count = form.row, len(entering)
    rows, block = np.empty((count, row.width)), np.zeros((min(BLOCK, count) + 1, row.width))
    stepper = _Stepper(given, form, block)
    block[0, row.next_values] = entering.first(form, linear)
    with np.errstate(over="ignore", invalid="ignore"):
        for start in range(0, count, BLOCK):
            size = min(BLOCK, count - start)
            stepper.advance(entering.block(form, linear, start, start + size))
            rows[start : start + size] = block[:size]
            block[0, row.next_values] = block[size, row.next_values]
            require_finite(given, rows[start : start + size, row.bounded_states], start)
    return simulation_result(given, entering.reference, _series(given, linear, form, entering, rows=rows))


def _series(given: Machine, linear: Parts, form: Fused, entering: Inflow, *, rows: Array) -> Series:
    """What stands in the rows, and what follows from it without a loop: poses and motions."""
    row = form.row
    sense = rounder(given.resolution) or _copy_row
    readings = sense(rows[:, row.reading].T, np.empty((len(form.scale), len(rows)))).T * form.scale
    stroke = rows[:, row.stroke] + entering.strokes
    return Series(
        pose=rows[:, row.rounded] * form.scale @ given.pose.T,
        motions=rows[:, row.plant] @ linear.motion.T + stroke @ linear.motion_f.T + entering.disturbances @ linear.motion_w.T,
        command=rows[:, row.command].copy(),
        asked=rows[:, row.asked].copy(),
        given=rows[:, row.given].copy(),
        stroke=stroke,
        readings=readings,
    )


class _Stepper:
    """A machine that runs: its kernels, and the rows of a block as the places they read and write."""

    def __init__(self, given: Machine, form: Fused, block: Array) -> None:
        self._sense = rounder(given.resolution) or _copy_row
        self._hold, self._seen = reading_hold(given.reach / form.scale), np.zeros(len(form.scale))
        self._proportional = form.proportional if np.any(form.proportional) else None
        self._actuate = Actuation(given)
        self._feeds_back = any(name.startswith("applied.") for name in given.controller.input_names)
        self._step = form.step
        self._views = _views(form.row, block)

    def advance(self, entering: Array) -> None:
        """Take as many samples as there are rows in `entering`, from the block's first row on."""
        proportional, step, actuate, sense, feeds_back = self._proportional, self._step, self._actuate, self._sense, self._feeds_back
        hold, seen = self._hold, self._seen
        dot, add, subtract = np.dot, np.add, np.subtract
        for entry, (reading, rounded, base, command, asked, given, applied, stroke, taken, computed) in zip(
            entering, self._views, strict=False
        ):
            seen = hold(sense(reading, rounded), seen)
            if proportional is None:
                np.copyto(command, base)
            else:
                add(dot(proportional, rounded, out=command), base, out=command)
            actuate(command, asked, given, stroke)
            if feeds_back:
                subtract(given, asked, out=applied)
            add(dot(step, taken, out=computed), entry, out=computed)
        self._seen = seen.copy()  # its place is used again


def _views(row: Row, block: Array) -> list[tuple[Array, ...]]:
    """The places of each sample, the last one that of what is computed for the next; made once, for a view costs as much as a sum."""
    places = (row.reading, row.rounded, row.base, row.command, row.asked, row.given, row.applied, row.stroke, row.carried_over)
    return [(*(now[place] for place in places), after[row.next_values]) for now, after in pairwise(block)]


def _copy_row(values: Array, out: Array) -> Array:
    np.copyto(out, values)
    return out


def require_finite(given: Machine, rows: Array, start: int = 0) -> None:
    """Raise `DesignError` where the last of the rows (n, ...) is not finite: when the loop was lost, counting from the sample `start`.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> require_finite(machine(example.plant, example.controller), np.zeros((2, 1)))
    """
    if np.all(np.isfinite(rows[-1])):
        return
    beyond = start + int(np.argmax(~np.all(np.isfinite(rows), axis=-1)))
    what = f"its numbers have grown beyond bounds {beyond * given.step:g} s after the start: the loop is unstable"
    raise refuse("loop", what, "Lower the gains, or see the verdict on its stability for the mode that grows")
