"""Simulation of loops with noise."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields

import numpy as np

from flexstage.base.number import Array
from flexstage.control.simulation.machine import Machine
from flexstage.control.simulation.noise import noise_series
from flexstage.control.simulation.result import Series, Simulated, simulation_result
from flexstage.control.simulation.run import simulate
from flexstage.control.simulation.running import RunningLoop
from flexstage.control.study.resolve import ResolvedSetup, round_up
from flexstage.control.systems.closed import Loop

_TIME_CONSTANTS = 8.0
_SHORTEST, _LONGEST = 0.02, 2.0
_RINGING, _GONE, _LEAKED = 0.1, 1e-6, 1.5


def rest_time(closed: Loop, *, ringing: bool = False) -> float:
    """Return the time [s] for initial settling: eight time constants of the slowest pole, between 20 ms and 2 s, rounded up.

    Oscillating poles are included only if `ringing` is true, because feedforward excites them. Poles of charge leakage are not included.

    >>> from flexstage.control.example import integral_loop
    >>> rest_time(integral_loop(gain=300.0))
    0.05
    """
    poles = closed.system.poles
    rates = np.log(poles[np.abs(poles) > _GONE].astype(complex)) * closed.plant.hardware.rate
    leaks = [_LEAKED * 2.0 * np.pi * each.charge.corner for each in closed.plant.hardware.amplifiers.values() if each.charge is not None]
    rates = rates[-rates.real > max(leaks, default=-np.inf)]
    calm = -rates.real[-rates.real > _RINGING * np.abs(rates)]
    slowest = float(np.min(calm)) if len(calm) and not ringing else float(np.min(-rates.real)) if leaks else -closed.system.growth
    wanted = float(np.clip(_TIME_CONSTANTS / slowest, _SHORTEST, _LONGEST))
    return round_up(wanted)


@dataclass(frozen=True, eq=False)
class DisturbedLoop:
    """Loop with noise. The noise starts `rest` [s] before a simulation, so that it is stationary during the simulation.

    During this time, floor vibration increases smoothly from zero.
    """

    given: ResolvedSetup
    machine: Machine
    rest: float

    def simulate(self, poses: Array, number: int = 0, held: Array | float = 0.0) -> Simulated:
        """Simulate n commanded poses (n, f), starting at rest in the pose `held` (f,); the noise depends on `number`."""
        lead, series = self._noise(len(poses), number)
        if not series and not np.any(held):
            return simulate(self.machine, poses)
        before = np.zeros((lead, poses.shape[1])) + held
        return part_of(self.machine, simulate(self.machine, np.concatenate([before, poses]), series), slice(lead, None))

    def begin(self, count: int) -> Callable[[Array], Array]:
        """Start a simulation of `count` samples; return a function that continues it with commanded poses and returns measured poses."""
        lead, series = self._noise(count, 0)
        running = RunningLoop(self.machine, series)
        running.advance(np.zeros((lead, len(self.machine.names))))
        return lambda commanded: running.advance(commanded).pose

    def _noise(self, count: int, number: int) -> tuple[int, Mapping[str, Array]]:
        """Samples before `count` others, and the noise of all of them."""
        lead = int(self.rest / self.given.step)
        noise = noise_series(self.given.plant, self.given.floor, lead + count, self.given.setup.seed + number)
        share = np.clip(np.arange(lead + count) / max(lead, 1), 0.0, 1.0)
        gentle = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
        return lead, {name: values * gentle if name.startswith("ground.") else values for name, values in noise.items()}


def part_of(given: Machine, found: Simulated, part: slice) -> Simulated:
    """Return the samples `part` of a simulation; times and fractions of time at limits refer to these samples."""
    return simulation_result(given, Series(**{field.name: getattr(found, field.name)[part] for field in fields(Series)}))
