"""Steps, immediate or within limits of speed, acceleration and jerk."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.number import Array
from flexstage.control.trajectory.pieces import Pieces
from flexstage.control.trajectory.profile import Limits, profile


@dataclass(frozen=True, eq=False)
class Step(CheckedFields):
    """Move to the pose `to` (by coordinate [m, rad]) that starts at the time `start` [s]: a jump, or a straight path within `limits`.

    All coordinates move in proportion. `limits` apply to the length of the path: the translation [m] or, for a pure rotation, the angle
    [rad].

    >>> step = Step({"x": 3e-6, "y": 4e-6}, limits=Limits(speed=1e-3, acceleration=1.0, jerk=32.0))
    >>> step.at(np.array([0.0, 1.0])).round(15).tolist(), step.coordinates
    ([[0.0, 0.0], [3e-06, 4e-06]], ('x', 'y'))
    """

    to: Mapping[str, float]
    start: float = 0.0
    limits: Limits | None = None

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the moving coordinates."""
        return tuple(self.to)

    @property
    def duration(self) -> float:
        """End time of the move [s]."""
        return self.start + (0.0 if self.limits is None else self._course(self.limits).duration)

    def at(self, times: Array) -> Array:
        """Compute poses (n, c) [m, rad] at `times` (n,) [s]."""
        passed = np.asarray(times, dtype=float) - self.start
        share = 1.0 * (passed >= 0.0)[:, None] if self.limits is None else self._course(self.limits).at(passed) / self._length
        return share * np.array(list(self.to.values()), dtype=float)

    def _course(self, limits: Limits) -> Pieces:
        return profile(self._length, limits)

    @property
    def _length(self) -> float:
        """Length of the translation, else the angle; 1 without motion, to keep ratios finite."""
        moved = np.sqrt(sum(value**2 for name, value in self.to.items() if not name.startswith("r")))
        turned = np.sqrt(sum(value**2 for name, value in self.to.items() if name.startswith("r")))
        return float(moved or turned or 1.0)
