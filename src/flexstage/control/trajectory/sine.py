"""A sine, on one coordinate or several."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.number import Array
from flexstage.control.trajectory.pieces import join, smooth
from flexstage.mechanism.mechanism import PLATFORM


@dataclass(frozen=True, eq=False)
class Sine(CheckedFields):
    """a sin(2 pi f (t - start)) from `start` [s] on: `amplitudes` a by coordinate [m, rad], `frequency` f [Hz].

    `phases` by coordinate [rad] are added to the angle (none: 0); `fade` [s] is how long the amplitude grows from nought, smoothly. Without
    a fade it starts with a jump of speed, or of position where there is a phase.

    >>> round(float(Sine({"x": 1e-6}, frequency=10.0).at(np.array([0.025]))[0, 0]), 12)
    1e-06
    """

    amplitudes: Mapping[str, float]
    frequency: float
    phases: Mapping[str, float] | None = None
    start: float = 0.0
    fade: float = 0.0
    point: str = PLATFORM

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates that move."""
        return tuple(self.amplitudes)

    @property
    def duration(self) -> float:
        """It never ends."""
        return np.inf

    def at(self, times: Array) -> Array:
        """Poses (n, c) at `times` (n,) [s]."""
        passed = np.asarray(times, dtype=float) - self.start
        phases = np.array([(self.phases or {}).get(name, 0.0) for name in self.amplitudes])
        waves = np.array(list(self.amplitudes.values())) * np.sin(2.0 * np.pi * self.frequency * passed[:, None] + phases)
        return np.where(passed[:, None] >= 0.0, waves, 0.0) * self._growth(passed)

    def _growth(self, passed: Array) -> Array | float:
        if not self.fade:
            return 1.0
        return join([(self.fade, smooth(np.zeros(1), np.ones(1), self.fade))]).at(passed)
