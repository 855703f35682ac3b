"""Archimedean spirals at constant path speed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.control.trajectory.path import require_positive
from flexstage.control.trajectory.pieces import Pieces, join


@dataclass(frozen=True, eq=False)
class Spiral(CheckedFields):
    """Spiral r = b theta from 0 to a final `radius` [m], with a `pitch` = 2 pi b between turns [m], at constant path `speed` [m/s].

    `ramp` [s] is the duration of the linear speed rise at the start, and of the fall at the end. The path's length is s = (b/2) (theta (1 +
    theta^2)^(1/2) + arsinh theta); Newton's method computes theta to rounding error.

    >>> spiral = Spiral(radius=10e-6, pitch=1e-6, speed=1e-3)
    >>> np.hypot(*spiral.at(np.array([9.0])).T).round(12).tolist()
    [1e-05]
    """

    radius: float
    pitch: float
    speed: float
    ramp: float = 0.0
    coordinates: tuple[str, str] = ("x", "y")

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive("spiral: ", {"radius": self.radius, "pitch": self.pitch, "speed": self.speed})
        if not 0.0 <= self.ramp <= self._whole / self.speed:
            what = f"out of range (got {self.ramp:g} s, expected 0 to {self._whole / self.speed:g} s at this speed)"
            raise refuse("spiral: ramp", what, "Shorten the ramp, or reduce the speed")

    @property
    def duration(self) -> float:
        """Duration of the spiral [s]."""
        return self._progress.duration

    def at(self, times: Array) -> Array:
        """Compute poses (n, 2) [m, rad] at `times` (n,) [s]."""
        angle = _angle(self._progress.at(np.asarray(times, dtype=float))[:, 0] / self._growth)
        return self._growth * angle[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    @property
    def _growth(self) -> float:
        """Increase b of the radius per radian."""
        return self.pitch / (2.0 * np.pi)

    @property
    def _whole(self) -> float:
        """Length of the path [m]."""
        return self._growth * float(_length(np.array(self.radius / self._growth)))

    @cached_property
    def _progress(self) -> Pieces:
        """Path length over time: acceleration, constant speed, deceleration."""
        pace, ramp = self.speed, self.ramp
        even, first = self._whole / pace - ramp, 0.5 * pace * ramp
        bend = 0.5 * pace / ramp if ramp else 0.0
        parts = [(ramp, [0.0, 0.0, bend]), (even, [first, pace, 0.0]), (ramp, [first + pace * even, pace, -bend])]
        return join((time, np.array([*values, 0.0, 0.0, 0.0])[:, None]) for time, values in parts)


def _length(angle: Array) -> Array:
    """Length of the path over b."""
    return 0.5 * (angle * np.sqrt(1.0 + angle**2) + np.arcsinh(angle))


def _angle(length: Array) -> Array:
    """Angles for these path lengths over b: the length is convex and increasing, so Newton's method from above converges."""
    angle = np.minimum(np.sqrt(2.0 * length), length)
    for _ in range(20):
        angle = angle - (_length(angle) - length) / np.sqrt(1.0 + angle**2)
    return angle
