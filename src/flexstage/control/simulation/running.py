"""Running loop, sample by sample: whole simulations, and loops with a reference supplied during the run."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Array
from flexstage.control.simulation.actuation import Actuation, rounder
from flexstage.control.simulation.disturbances import inflow
from flexstage.control.simulation.machine import Machine
from flexstage.control.simulation.parts import parts
from flexstage.control.simulation.result import Series


class RunningLoop:
    """Loop simulated by `advance`, initially at rest.

    `disturbances` are series (`count`,), named as in `simulate`; the default `count` is the length of the longest series. After their end,
    the series are replayed backwards, which preserves noise spectra. An axis that is not `held` uses its pose as reference: its error is
    zero, without restoring action.
    """

    def __init__(self, given: Machine, disturbances: Mapping[str, Array], count: int | None = None) -> None:
        linear = self._linear = parts(given)
        self._length = count or max((len(each) for each in disturbances.values()), default=1)
        self.machine, self._entering = given, inflow(given, self._length, disturbances)
        self._plant = np.hstack([linear.A, linear.stroke])
        self._command = np.hstack([linear.command, linear.command_r, linear.command_q])
        self._next = np.hstack([linear.controller, linear.from_reference, linear.from_pose, linear.from_applied])
        f, m = len(given.names), len(given.actuators)
        self._ends = np.cumsum([len(linear.A), m, len(linear.controller), f, f, m, m, m, m, len(given.gauges)])
        self._sense = rounder(given.resolution)
        self.reset()

    def reset(self) -> None:
        """Reset the loop to its state at rest."""
        self._row = np.zeros(self._ends[-1])
        self._actuate, self._taken = Actuation(self.machine), np.zeros(len(self.machine.gauges))
        self.count = 0
        """Samples since the reset."""

    def advance(self, wanted: Array, held: Array | None = None) -> Series:
        """Simulate a sample for each row of the references `wanted` (n, f); `held` (f,) marks the servo-controlled axes (default: all).

        If numbers diverge, resets the loop and raises `DesignError`.
        """
        linear, row, ends, reach, rows = self._linear, self._row, self._ends, self.machine.reach, np.empty((len(wanted), self._ends[-1]))
        x, stroke, z, reference, pose, applied, command, asked, gives, reading = np.split(row, ends[:-1])
        of_plant, known, of_control = row[: ends[1]], row[ends[1] : ends[4]], row[ends[1] : ends[5]]
        places = self._places(len(wanted))
        shaken, read, added = (each[places] for each in self._entering)
        noises = shaken @ linear.reading_w.T + read
        drives = shaken @ linear.disturbed.T + added @ linear.stroke.T
        with np.errstate(over="ignore", invalid="ignore"):
            for out, asked_for, noise, drive in zip(rows, wanted, noises, drives, strict=True):
                reading[:] = self._sense(linear.reading @ x + noise)
                self._taken = np.where(np.abs(reading) <= reach, reading, self._taken)
                pose[:] = self.machine.pose @ self._taken
                reference[:] = asked_for if held is None else np.where(held, asked_for, pose)
                command[:] = self._command @ known
                asked[:], gives[:], stroke[:] = self._actuate(command)
                applied[:] = gives - asked
                out[:] = row
                x[:] = self._plant @ of_plant + drive
                z[:] = self._next @ of_control
        self.count += len(wanted)
        try:
            require_finite(self.machine, rows[:, : ends[7]])
        except DesignError:
            self.reset()
            raise
        states, strokes, _, *signals, readings = np.split(rows, ends[:-1], axis=1)
        motions = states @ linear.motion.T + (strokes + added) @ linear.motion_f.T + shaken @ linear.motion_w.T
        references, poses, _, commands, all_asked, all_given = signals
        return Series(references, poses, motions, commands, all_asked, all_given, strokes + added, readings)

    def _places(self, n: int) -> Array:
        """Rows of the disturbances for the next samples: to their end and back."""
        last = self._length - 1
        turned = (self.count + np.arange(n)) % max(2 * last, 1)
        return np.where(turned > last, 2 * last - turned, turned)


def require_finite(given: Machine, rows: Array) -> None:
    """Raise `DesignError` if some of the rows (n, ...) are not finite, with the time of divergence.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> require_finite(machine(example.plant, example.controller), np.array([[0.0], [np.inf]]))
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: loop: the simulation diverged 0.0001 s after the start: the loop is unstable. ...
    """
    lost = ~np.all(np.isfinite(rows), axis=-1)
    if np.any(lost):
        what = f"the simulation diverged {np.argmax(lost) * given.step:g} s after the start: the loop is unstable"
        raise refuse("loop", what, "Reduce the gains, or find the growing mode in the stability result")
