"""Force feedback as a computer runs it, in samples of its own between those of the pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.control.damping.force_feedback import ForceFeedback
from flexstage.control.damping.legs import Leg


@dataclass(frozen=True, eq=False)
class SampledLegs:
    """The law of `actuators`' legs (m,) every `step` [s], `turns` of which make a sample of the pose's loop.

    G = g s / (s + a)^2 (with `order` 1, g / (s + a)) by s = 2/step (z - 1)/(z + 1): one low pass a / (s + a) after `gains` g / (a k) (m,)
    [m/N], and less another one of what comes out of it, so that single precision loses nothing to slow poles. `share` is
    a step / (2 + a step).
    """

    actuators: tuple[str, ...]
    gains: Array
    share: float
    order: int
    step: float
    turns: int

    def strokes(self, tensions: Array) -> Array:
        """What is added to the strokes (n, m) [m] by tensions (n, m) [N], from rest.

        >>> held = SampledLegs(("B",), np.array([2e-8]), 1e-2, 1, 1e-5, 10)
        >>> held.strokes(np.full((2000, 1), 50.0))[-1].round(12).tolist()
        [1e-06]
        """
        first, second, found = np.zeros(len(self.gains)), np.zeros(len(self.gains)), np.empty(np.shape(tensions))
        for number, tension in enumerate(tensions):
            entry = self.share * self.gains * tension
            slow = entry + first
            first = entry + slow - 2.0 * self.share * slow
            found[number] = slow
            if self.order == 2:
                entry = self.share * slow
                slower = entry + second
                second = entry + slower - 2.0 * self.share * slower
                found[number] -= slower
        return found


def sample_legs(law: ForceFeedback, legs: tuple[Leg, ...], rate: float, turns: int) -> SampledLegs:
    """A law at a `rate` [Hz], `turns` samples to one of the pose; lag and delay are those of the hardware, not of the code."""
    turning = 2.0 * np.pi * law.corner
    share = turning / (2.0 * rate + turning)
    gains = np.array([law.gain / (turning * each.stiffness) for each in legs])
    return SampledLegs(tuple(each.actuator for each in legs), gains, share, law.order, 1.0 / rate, turns)
