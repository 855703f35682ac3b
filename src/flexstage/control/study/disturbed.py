"""Loops that are simulated in their noise."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.control.simulation.machine import Machine
from flexstage.control.simulation.noise import noise_series
from flexstage.control.simulation.result import Simulated
from flexstage.control.simulation.run import simulate
from flexstage.control.simulation.running import RunningLoop
from flexstage.control.study.resolve import ResolvedSetup, round_up
from flexstage.control.systems.closed import Loop

_TIME_CONSTANTS = 8.0
_SHORTEST, _LONGEST = 0.02, 2.0
_RINGING, _GONE, _LEAKED = 0.1, 1e-6, 1.5


def rest_time(closed: Loop, *, ringing: bool = False) -> float:
    """How long [s] the loop is given to settle: eight times the time constant of its slowest pole, at most 2 s.

    Poles that ring count only where they are set `ringing`, by commands that pass the controller by; charge that leaks away is not awaited.

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
    """A loop in its noise, which begins `rest` [s] before a simulation does, so that it is stationary by then.

    The floor begins to shake gently, not at once.
    """

    given: ResolvedSetup
    machine: Machine
    rest: float

    def simulate(self, poses: Array, number: int = 0, held: Array | float = 0.0) -> Simulated:
        """A simulation of commanded poses (n, f), the `number` of which gives its random numbers, from a pose that is `held` before."""
        lead, series = self._noise(len(poses), number)
        if not series and not np.any(held):
            return simulate(self.machine, poses)
        before = np.zeros((lead, poses.shape[1])) + held
        return part_of(simulate(self.machine, np.concatenate([before, poses]), series), slice(lead, None))

    def begin(self, count: int) -> Callable[[Array], Array]:
        """A loop of so many samples that runs on by commanded poses and returns the pose, in the noise of number 0."""
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


def part_of(found: Simulated, part: slice) -> Simulated:
    """The samples of a simulation in a slice, their time from its start; shares of limits are those of the whole."""
    names = [field.name for field in fields(Simulated) if np.shape(getattr(found, field.name))[:1] == found.times.shape]
    kept = {name: getattr(found, name)[part] for name in names}
    return replace(found, **(kept | {"times": found.times[part] - found.times[part.start]}))
