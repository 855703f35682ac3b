"""What comes into a loop from outside, sample by sample: reference, disturbances, noise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.control.simulation.fused import Fused, Parts
from flexstage.control.simulation.machine import Machine


@dataclass(frozen=True, eq=False)
class Inflow:
    """`reference` (n, f) [m, rad], `disturbances` (n, w) of the plant, `readings` (n, g) [m] and `strokes` (n, m) [m] added to both."""

    reference: Array
    disturbances: Array
    readings: Array
    strokes: Array

    def __len__(self) -> int:
        """Number of samples."""
        return len(self.reference)

    def first(self, form: Fused, linear: Parts) -> Array:
        """What the first row begins with: at rest, seen through noise, and asked for the first reference."""
        found = np.zeros(form.row.next_values.stop)
        found[form.row.reading] = (linear.reading_w @ self.disturbances[0] + self.readings[0]) / form.scale
        found[form.row.base] = linear.command_r @ self.reference[0]
        return found

    def block(self, form: Fused, linear: Parts, start: int, stop: int) -> Array:
        """What is added to the rows `start` + 1 to `stop` (stop - start, computed): one product a kind for many samples."""
        now, after = slice(start, stop), np.minimum(np.arange(start + 1, stop + 1), len(self) - 1)
        found = np.zeros((stop - start, form.row.next_values.stop))
        plant = self.disturbances[now] @ linear.disturbed.T + self.strokes[now] @ linear.stroke.T
        controller = self.reference[now] @ linear.from_reference.T
        seen = plant @ linear.reading.T + self.disturbances[after] @ linear.reading_w.T + self.readings[after]
        found[:, form.row.plant], found[:, form.row.controller] = plant, controller
        found[:, form.row.reading] = seen / form.scale
        found[:, form.row.base] = controller @ linear.command.T + self.reference[after] @ linear.command_r.T
        return found


def inflow(given: Machine, reference: Array, disturbances: Mapping[str, Array]) -> Inflow:
    """The reference (n, f) and named series (n,) put in a machine's order; what is not named is nought.

    Names are those of the plant's further inputs (`ground.x`, `platform.fz`) and `noise.<gauge>`, `noise.<actuator>` [m]. Raises
    `DesignError` for others, for lengths that differ, and for numbers that are not finite, but of `noise.<gauge>`: that reading is lost.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> known = machine(example.plant, example.controller)
    >>> inflow(known, np.zeros((2, 1)), {"noise.S": np.array([1e-9, 2e-9])}).readings.tolist()
    [[1e-09], [2e-09]]
    """
    reference = np.asarray(reference, dtype=float)
    named = {name: np.asarray(values, dtype=float) for name, values in disturbances.items()}
    require(_findings(given, reference, named))
    groups = (tuple(channel.name for channel in given.disturbances), *(_noises(names) for names in (given.gauges, given.actuators)))
    nothing = np.zeros(len(reference))
    columns = (np.stack([named.get(name, nothing) for name in names], axis=-1) if names else nothing[:, None][:, :0] for names in groups)
    return Inflow(reference, *columns)


def _noises(names: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"noise.{name}" for name in names)


def _findings(given: Machine, reference: Array, named: Mapping[str, Array]) -> Iterator[Finding]:
    if reference.ndim != 2 or reference.shape[1:] != (len(given.names),) or not len(reference):
        yield Finding("reference", f"it is {reference.shape}", f"Give a row a sample, with {', '.join(given.names)}")
        return
    if not np.all(np.isfinite(reference)):
        yield Finding("reference", "a number is not finite", "Mend the trajectory")
    known = [channel.name for channel in given.disturbances] + [*_noises(given.gauges), *_noises(given.actuators)]
    for name, values in named.items():
        if name not in known:
            yield Finding(name, "the loop has no input of this name", suggest_nearest(name, known))
        elif values.shape != (len(reference),):
            yield Finding(name, f"it is {values.shape}, where the reference has {len(reference)} samples", "Give as many")
        elif name not in _noises(given.gauges) and not np.all(np.isfinite(values)):
            yield Finding(name, "a number is not finite", "Mend the series")
