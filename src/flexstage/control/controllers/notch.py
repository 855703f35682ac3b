"""Notch filters at a stage's modes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import Finding, require
from flexstage.base.units.quantity import FREQUENCY
from flexstage.control.systems.sampling import bilinear
from flexstage.control.systems.system import System
from flexstage.models.linear.model import Channel

_WIDTH = 0.7
_FAR = 0.1


@dataclass(frozen=True)
class Notch(CheckedFields):
    """Notch filter (s^2 + 2 d zeta w s + w^2) / (s^2 + 2 zeta w s + w^2): gain d = `depth` at w = 2 pi `frequency`, 1 far from w.

    `damping` zeta is the damping ratio of the poles. The gain is below 1/sqrt(2) in a band with a width of about 2 zeta times the
    frequency. A depth of zeta_m / zeta cancels a mode with the damping ratio zeta_m: the notch's poles replace the mode's poles. Raises
    `DesignError` for invalid numbers.

    >>> from flexstage.control.controllers.notch import Notch
    >>> gains = Notch(frequency=110.9, depth=0.02).system().transfer(np.array([0.0, 110.9]))
    >>> abs(gains.ravel()).round(12).tolist()
    [1.0, 0.02]
    """

    frequency: Annotated[float, FREQUENCY]
    depth: float = 0.0
    damping: float = _WIDTH

    def __post_init__(self) -> None:
        super().__post_init__()
        where, found = f"notch at {self.frequency:g} Hz", []
        if not 0.0 < self.frequency < np.inf:
            found.append(Finding(where, "frequency must be positive", "Use the frequency of a mode"))
        if not 0.0 <= self.depth <= 1.0:
            found.append(Finding(where, f"depth out of range (got {self.depth:g}, expected 0 to 1)", "Use 1 for no notch"))
        if not 0.0 < self.damping < np.inf:
            found.append(Finding(where, f"damping of the poles must be positive (got {self.damping:g})", "Use e.g. 0.7"))
        require(found)

    def system(self, step: float | None = None) -> System:
        """Return the filter from `raw` to `notched`, discretised by Tustin's rule with prewarping, so that it is exact at the notch.

        Raises `DesignError` for a notch above half the sampling rate.
        """
        omega = 2.0 * np.pi * self.frequency
        change = 2.0 * (self.depth - 1.0) * self.damping * omega
        A = np.array([[0.0, omega], [-omega, -2.0 * self.damping * omega]])
        channels = (Channel("raw", "m"),), (Channel("notched", "m"),)
        found = System(A, np.array([[0.0], [1.0]]), np.array([[0.0, change]]), np.eye(1), *channels)
        if step is None:
            return found
        if self.frequency >= 0.5 / step:
            what = f"not below half the sampling rate, {0.5 / step:g} Hz"
            require([Finding(f"notch at {self.frequency:g} Hz", what, f"Sample above {2.0 * self.frequency:g} Hz, or omit the notch")])
        return bilinear(found, step, self.frequency)


@check_arguments
def notch_of_mode(frequency: float, ratio: float, damping: float = _WIDTH) -> Notch:
    """Compute the notch filter that cancels a mode with the natural `frequency` [Hz] and the damping `ratio`.

    The notch's zeros cancel the poles of the mode. The notch's poles have the damping ratio `damping`, and its depth is `ratio` /
    `damping`. A mode with more damping than the notch's poles needs no notch: the result then has depth 1.

    >>> notch_of_mode(110.9, 0.01).depth.__round__(4)
    0.0143
    """
    return Notch(frequency, min(ratio / damping, 1.0), damping)


def notch_findings(notches: Iterable[Notch], frequencies: Iterable[float]) -> list[Finding]:
    """Find notches that are more than 10 % away from every mode of `frequencies` [Hz]. Each finding gives the nearest modes.

    >>> [str(each) for each in notch_findings([Notch(135.0)], [106.0, 106.0, 150.0])]
    ['notch at 135 Hz: no mode within 10 % (nearest: 106 Hz and 150 Hz). Move the notch to the mode that limits the loop, or omit it.']
    """
    modes = sorted(frequencies)
    found = []
    for each in notches:
        if any(abs(mode / each.frequency - 1.0) <= _FAR for mode in modes):
            continue
        below = [mode for mode in modes if mode < each.frequency]
        above = [mode for mode in modes if mode > each.frequency]
        side = f"highest: {below[-1]:g} Hz" if below else "the stage has none"
        if above:
            side = f"nearest: {below[-1]:g} Hz and {above[0]:g} Hz" if below else f"lowest: {above[0]:g} Hz"
        advice = "Move the notch to the mode that limits the loop, or omit it"
        found.append(Finding(f"notch at {each.frequency:g} Hz", f"no mode within {100.0 * _FAR:g} % ({side})", advice))
    return found
