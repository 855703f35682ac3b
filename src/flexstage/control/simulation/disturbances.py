"""External inputs of a loop, sample by sample: disturbances and noise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.control.simulation.machine import Machine
from flexstage.control.systems.system import names_of


def inflow(given: Machine, count: int, disturbances: Mapping[str, Array]) -> list[Array]:
    """Arrange named series (n,) of `count` samples in the order of the loop's inputs; missing series are zero.

    The three groups of series are disturbances (n, w) of the plant, noise of readings (n, g) [m], and noise of strokes (n, m) [m].

    A name is a plant input other than a stroke, for example `ground.x` or `platform.fz`, or it is `noise.<gauge>` or `noise.<actuator>`
    [m]. Raises `DesignError` for unknown names, different lengths, and numbers that are not finite. A non-finite `noise.<gauge>` marks a
    lost reading.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> known = machine(example.plant, example.controller)
    >>> inflow(known, 2, {"noise.S": np.array([1e-9, 2e-9])})[1].tolist()
    [[1e-09], [2e-09]]
    """
    named = {name: np.asarray(values, dtype=float) for name, values in disturbances.items()}
    readings, strokes = ([f"noise.{name}" for name in names] for names in (given.gauges, given.actuators))
    groups = names_of(given.disturbances), readings, strokes
    require(_findings(named, [name for names in groups for name in names], count, readings))
    return [np.array([named.get(name, np.zeros(count)) for name in names]).reshape(-1, count).T for names in groups]


def _findings(named: Mapping[str, Array], known: list[str], count: int, readings: list[str]) -> Iterator[Finding]:
    for name, values in named.items():
        if name not in known:
            yield Finding(name, "unknown input of the loop", suggest_nearest(name, known))
        elif values.shape != (count,):
            yield Finding(
                name, f"wrong length (got {values.shape}, expected {count} samples, the length of the reference)", "Use this length"
            )
        elif name not in readings and not np.all(np.isfinite(values)):
            yield Finding(name, "a number is not finite", "Correct the series")
