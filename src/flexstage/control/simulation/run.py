"""Time-domain simulation of a loop, sample by sample, in numpy."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from flexstage.base.arguments import GAPS, check_arguments
from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.control.simulation.machine import Machine
from flexstage.control.simulation.result import Simulated, simulation_result
from flexstage.control.simulation.running import RunningLoop

_NONE: Mapping[str, Array] = {}


@check_arguments
def simulate(given: Machine, reference: Array, disturbances: Mapping[str, Annotated[Array, GAPS]] = _NONE) -> Simulated:
    """Simulate the loop's response to a reference (n, f) [m, rad] and disturbances (n,), from rest, sample by sample.

    `disturbances` contains one series (n,) for each name. Names such as `ground.<c>` and `platform.fx` are inputs of the plant. A series
    `noise.<gauge>` [m] is added to the readings of the gauge before rounding; where the series is not finite, the reading is lost. A series
    `noise.<actuator>` [m] is added to the free stroke of the actuator. The simulation itself generates no noise (see `noise_series`).
    Between samples, strokes and wrenches are constant and ground motion is linear; the plant has no integration error (see
    `zero_order_hold`). Raises `DesignError` for unknown names, series of different lengths, and a diverging simulation.

    >>> import numpy as np
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> found = simulate(machine(example.plant, example.controller), np.full((2000, 1), 1e-6))
    >>> round(float(found.pose[-1, 0]) * 1e9, 2)  # an integrator leaves no error: 1000 nm
    1000.0
    """
    if reference.ndim != 2 or reference.shape[1] != len(given.names) or not len(reference):
        raise refuse("reference", f"wrong shape (got {reference.shape})", f"Use one row per sample, with columns {', '.join(given.names)}")
    return simulation_result(given, RunningLoop(given, disturbances, len(reference)).advance(reference))
