"""Voltage amplifiers of piezo stacks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.number import Array
from flexstage.base.units.quantity import CURRENT, FREQUENCY, POSITIVE, RESISTANCE


@dataclass(frozen=True)
class Amplifier(CheckedFields):
    """Voltage amplifier with a first-order lag, which drives the capacitance C of a stack; ideal if no field is specified.

    The bandwidth [Hz] is the specified `bandwidth`, or 1/(2 pi R C) with the output `resistance` R [ohm]. `current` [A] is the largest
    output current.
    """

    bandwidth: Annotated[float, FREQUENCY, POSITIVE] | None = None
    resistance: Annotated[float, RESISTANCE, POSITIVE] | None = None
    current: Annotated[float, CURRENT, POSITIVE] | None = None

    def cutoff(self, capacitances: Array) -> Array:
        """Return the bandwidth [Hz] for load capacitances [F]; infinite if the amplifier has no lag.

        >>> Amplifier(resistance=100.0).cutoff(np.array([0.4e-6])).round(1).tolist(), Amplifier().cutoff(np.ones(1)).tolist()
        ([3978.9], [inf])
        """
        if self.resistance is not None:
            return 1.0 / (2.0 * np.pi * self.resistance * capacitances)
        return np.full(np.shape(capacitances), np.inf if self.bandwidth is None else self.bandwidth)
