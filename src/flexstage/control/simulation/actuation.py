"""From commands to free strokes, one sample after the other: inverse, converter, limits, hysteresis."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.control.simulation.kernel import Compensator, converter, limiter
from flexstage.control.simulation.machine import Machine


class Actuation:
    """The actuators of a machine as they run: holds the strokes last given, the hysteresis and its inverse; at the bias at first."""

    __slots__ = (
        "_bias",
        "_compensator",
        "_convert",
        "_gain",
        "_hysteresis",
        "_last",
        "_leaked",
        "_limit",
        "_modelled",
        "_plain",
        "_relief",
        "_rest",
        "_volts",
    )

    def __init__(self, given: Machine) -> None:
        bias, model, compensation = given.amplifiers.bias, given.hysteresis, given.compensation
        self._convert = converter(given.amplifiers.step)
        self._limit = limiter(given.amplifiers, given.step)
        self._last, self._volts = np.zeros(len(given.actuators)), np.empty(len(given.actuators))
        self._gain, self._bias = given.amplifiers.gain, bias
        self._plain = model is None and compensation is None
        self._compensator = None if compensation is None else Compensator(compensation, bias)
        self._modelled = bias if compensation is None else compensation.step(compensation.start(bias), bias)[1]
        self._hysteresis = None if model is None else model.stepper(model.start(bias))
        self._rest = bias if model is None else model.step(model.start(bias), bias)[1]
        self._relief, self._leaked = given.relief, np.zeros(len(given.actuators))

    def __call__(self, command: Array, asked: Array, given: Array, stroke: Array) -> None:
        """Take the command (m,) of the next sample; write what is asked of the amplifiers, what they give, and the free stroke [m].

        The place `given` must keep its numbers until the next call.
        """
        if self._compensator is None:
            np.copyto(asked, command)
        else:
            self._invert(self._compensator, command, asked)
        if self._convert is not None:
            self._convert(asked, asked)
        self._last = self._limit(asked, self._last, given)
        if self._plain:
            np.copyto(stroke, given)
        else:
            self._stretch(given, stroke)

    def _invert(self, compensator: Compensator, command: Array, asked: Array) -> None:
        """Strokes in proportion to the volts that make the command."""
        np.add(command, self._modelled, out=asked)
        compensator.volts(asked, asked)
        np.subtract(asked, self._bias, out=asked)
        np.multiply(asked, self._gain, out=asked)

    def _stretch(self, given: Array, stroke: Array) -> None:
        """Free strokes from what is given, counted from those at the bias."""
        volts = np.divide(given, self._gain, out=self._volts)
        np.add(volts, self._bias, out=volts)
        if self._compensator is not None:
            self._compensator.move_to(volts)
        if self._hysteresis is None:
            np.copyto(stroke, given)
        else:
            np.subtract(self._hysteresis(volts, stroke), self._rest, out=stroke)
        if self._relief is not None:
            own = stroke - given
            stroke += (1.0 - self._relief.residual_hysteresis) * (self._leaked - own)
            self._leaked += self._relief.leak * (own - self._leaked)
