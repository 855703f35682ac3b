"""A loop that goes on: what `simulate` computes, sample after sample, with a reference that is only known as it comes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from flexstage.base.number import Array
from flexstage.control.simulation.actuation import Actuation
from flexstage.control.simulation.disturbances import inflow
from flexstage.control.simulation.fused import parts
from flexstage.control.simulation.kernel import reading_hold, rounder
from flexstage.control.simulation.machine import Machine


@dataclass(frozen=True, eq=False)
class Stretch:
    """Samples that were run, a row each: what was `wanted`, `pose` and strokes `given`, as in `Simulated`; `readings` of the gauges."""

    wanted: Array
    pose: Array
    given: Array
    readings: Array


class RunningLoop:
    """A machine at rest that is run on by `advance`.

    `noise` are series (n,) by name as `simulate` takes them; at their end they run back to their beginning, which leaves their spectra as
    they are. An axis that is not held takes what it reads for what is wanted: its error is nought, and nothing pulls it back.
    """

    def __init__(self, given: Machine, noise: Mapping[str, Array]) -> None:
        linear = parts(given)
        length = max((len(each) for each in noise.values()), default=1)
        entering = inflow(given, np.zeros((length, len(given.names))), noise)
        self.machine = given
        self._seen_noise = entering.disturbances @ linear.reading_w.T + entering.readings
        self._moved = entering.disturbances @ linear.disturbed.T + entering.strokes @ linear.stroke.T
        self._sight = np.ascontiguousarray(linear.reading)
        self._plant = np.ascontiguousarray(np.hstack([linear.A, linear.stroke]))
        self._command = np.ascontiguousarray(np.hstack([linear.command, linear.command_r, linear.command_q]))
        self._next = np.ascontiguousarray(np.hstack([linear.controller, linear.from_reference, linear.from_pose, linear.from_applied]))
        self._step = np.where(given.resolution > 0.0, given.resolution, 1.0)
        self._sense, self._hold = rounder(given.resolution), reading_hold(given.reach / self._step)
        self.reset()

    def reset(self) -> None:
        """Put it back to rest."""
        given, states = self.machine, len(self._next)
        sizes = np.cumsum([0, states, *(len(given.names),) * 2, len(given.actuators)])
        self._row, self._plant_row = np.zeros(sizes[-1]), np.zeros(self._plant.shape[1])
        self._z, self._r, self._q, self._applied = (self._row[a:b] for a, b in pairwise(sizes))
        self._x, self._stroke = self._plant_row[: len(self._plant)], self._plant_row[len(self._plant) :]
        self._actuate, self._last = Actuation(given), np.zeros(len(given.gauges))
        self.count = 0
        """Samples since it was at rest."""

    def advance(self, wanted: Array, held: Array) -> Stretch:
        """Run as many samples as `wanted` (n, f) has rows, with the axes that are `held` (f,).

        Raises `FloatingPointError` where numbers grow beyond bounds, and is then at rest.
        """
        n, given = len(wanted), self.machine
        taken, poses = np.array(wanted, dtype=float), np.empty_like(wanted)
        gave, readings = np.empty((n, len(given.actuators))), np.empty((n, len(given.gauges)))
        free = None if np.all(held) else ~held
        command, asked = np.empty(len(given.actuators)), np.empty(len(given.actuators))
        places = self._noise_places(n)
        with np.errstate(over="ignore", invalid="ignore"):
            for k, (seen_noise, moved) in enumerate(zip(self._seen_noise[places], self._moved[places], strict=True)):
                counted = (self._sight @ self._x + seen_noise) / self._step
                if self._sense is not None:
                    counted = self._sense(counted, np.empty_like(counted))
                readings[k] = counted * self._step
                self._last = self._hold(counted, self._last)
                np.dot(given.pose, self._last * self._step, out=self._q)
                if free is not None:
                    taken[k, free] = self._q[free]
                self._r[:] = taken[k]
                np.dot(self._command, self._row[: self._command.shape[1]], out=command)
                self._actuate(command, asked, gave[k], self._stroke)
                np.subtract(gave[k], asked, out=self._applied)
                poses[k] = self._q
                self._x[:] = self._plant @ self._plant_row + moved
                self._z[:] = self._next @ self._row
        self.count += n
        if not (np.all(np.isfinite(self._x)) and np.all(np.isfinite(self._z))):
            self.reset()
            raise FloatingPointError
        return Stretch(taken, poses, gave, readings)

    def _noise_places(self, n: int) -> Array:
        """Rows of the noise for the next samples: to its end and back."""
        last = len(self._moved) - 1
        turned = (self.count + np.arange(n)) % max(2 * last, 1)
        return np.where(turned > last, 2 * last - turned, turned)
