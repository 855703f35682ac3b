"""Actuation path from commands to free strokes, sample by sample: inverse, converter, limits, hysteresis."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexstage.base.number import Array
from flexstage.control.hysteresis.models.inverse import inverse, inverse_state
from flexstage.control.simulation.machine import Machine


def rounder(steps: Array) -> Callable[[Array], Array]:
    """Return a function that rounds numbers to multiples of `steps`, halves to the even multiple (step 0: no rounding).

    >>> rounder(np.array([0.0, 0.5]))(np.array([0.3, 1.7])).tolist()
    [0.3, 1.5]
    """
    coarse, scale = steps > 0.0, np.where(steps > 0.0, steps, 1.0)
    if not np.any(coarse):
        return lambda values: values
    return lambda values: np.where(coarse, np.rint(values / scale) * scale, values)


class Actuation:
    """Simulated actuators of a loop, initially at the bias, with the state of rate limits, hysteresis and inverse model.

    >>> from dataclasses import replace
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> known = machine(example.plant, example.controller)
    >>> known = replace(known, amplifiers=replace(known.amplifiers, high=np.array([1e-6])))
    >>> [each.tolist() for each in Actuation(known)(np.array([3e-6]))]
    [[3e-06], [1e-06], [1e-06]]
    """

    def __init__(self, given: Machine) -> None:
        bias, model, stacks = given.amplifiers.bias, given.compensation, given.hysteresis
        self._machine, self._convert, self._most = given, rounder(given.amplifiers.step), given.amplifiers.slew * given.step
        self._is_slow = np.any(np.isfinite(self._most))
        self._last = self._leaked = np.zeros(len(given.actuators))
        if model is not None:
            self._inverse, self._plays = inverse(model), model.start(bias)
            self._modelled = model.step(self._plays, bias)[1]
        if stacks is not None:
            self._stacks = stacks.start(bias)
            self._rest = stacks.step(self._stacks, bias)[1]

    def __call__(self, command: Array) -> tuple[Array, Array, Array]:
        """Compute requested, applied and free strokes (m,) [m] from the command (m,) of the next sample.

        The requested stroke is the amplifier input, the applied stroke the amplifier output. The three strokes are equal without inverse,
        converter, limits and hysteresis.
        """
        powers, model = self._machine.amplifiers, self._machine.compensation
        if model is not None:
            wanted = self._inverse.step(inverse_state(model, self._plays), command + self._modelled)[1]
            command = (wanted - powers.bias) * powers.gain
        asked, last = self._convert(command), self._last
        given = np.maximum(np.minimum(asked, powers.high), powers.low)
        if self._is_slow:
            given = np.maximum(np.minimum(given, last + self._most), last - self._most)
        self._last = given
        if model is not None:
            self._plays, _ = model.step(self._plays, given / powers.gain + powers.bias)
        return asked, given, given if self._machine.hysteresis is None else self._stretch(given)

    def _stretch(self, given: Array) -> Array:
        """Free strokes for applied ones, relative to the strokes at the bias."""
        powers, stacks, relief = self._machine.amplifiers, self._machine.hysteresis, self._machine.relief
        assert stacks is not None  # noqa: S101
        self._stacks, stroke = stacks.step(self._stacks, given / powers.gain + powers.bias)
        stroke = stroke - self._rest
        if relief is not None:
            own = stroke - given
            stroke = stroke + (1.0 - relief.residual_hysteresis) * (self._leaked - own)
            self._leaked = self._leaked + relief.leak * (own - self._leaked)
        return stroke
