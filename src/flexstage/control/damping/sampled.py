"""Sampled force feedback, at a multiple of the pose loop's rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.control.damping.force_feedback import ForceFeedback
from flexstage.control.damping.legs import Leg


@dataclass(frozen=True, eq=False)
class SampledLegs:
    """Force feedback in the legs of `actuators` (m,), sampled every `step` [s], `turns` times during one sample of the pose loop.

    The law G(s) of `ForceFeedback` is discretised by Tustin's rule. Each tension is multiplied by its gain and filtered by the low-pass
    filter a / (s + a). `gains` (m,) [m/N] are g / (a k), with the gain g, the corner a [1/s] and a leg's axial stiffness k. For order 2, an
    equal second filter follows, and its output is subtracted from its input. `share` is a T / (2 + a T), with T = `step`. The computation
    is accurate in single precision even if a T is small.
    """

    actuators: tuple[str, ...]
    gains: Array
    share: float
    order: int
    step: float
    turns: int

    def strokes(self, tensions: Array) -> Array:
        """Compute the strokes (n, m) [m] of the force feedback for tensions (n, m) [N], from zero state.

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
    """Discretise the force feedback at a `rate` [Hz], with `turns` samples per pose sample, without the hardware's lag and delay."""
    turning = 2.0 * np.pi * law.corner
    share = turning / (2.0 * rate + turning)
    gains = np.array([law.gain / (turning * each.stiffness) for each in legs])
    return SampledLegs(tuple(each.actuator for each in legs), gains, share, law.order, 1.0 / rate, turns)
