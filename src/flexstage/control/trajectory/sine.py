"""Sinusoidal trajectories of one or several coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.number import Array
from flexstage.control.trajectory.pieces import join, smooth


@dataclass(frozen=True, eq=False)
class Sine(CheckedFields):
    """Sine a sin(2 pi f t): `amplitudes` a by coordinate [m, rad], `frequency` f [Hz].

    `fade` [s] is the duration of a smooth amplitude rise from 0. Without a fade, the speed starts with a jump.

    >>> round(float(Sine({"x": 1e-6}, frequency=10.0).at(np.array([0.025]))[0, 0]), 12)
    1e-06
    """

    amplitudes: Mapping[str, float]
    frequency: float
    fade: float = 0.0

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the moving coordinates."""
        return tuple(self.amplitudes)

    @property
    def duration(self) -> float:
        """Duration [s], infinite."""
        return np.inf

    def at(self, times: Array) -> Array:
        """Compute poses (n, c) [m, rad] at `times` (n,) [s]."""
        passed = np.asarray(times, dtype=float)[:, None]
        growth = join([(self.fade, smooth(np.zeros(1), np.ones(1), self.fade))]).at(passed[:, 0]) if self.fade else 1.0
        return np.array(list(self.amplitudes.values())) * np.sin(2.0 * np.pi * self.frequency * passed) * growth
