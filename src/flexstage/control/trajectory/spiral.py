"""Archimedean spirals at even speed, or at an even rate of turns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.control.trajectory.pieces import Pieces, join
from flexstage.mechanism.mechanism import PLATFORM


@dataclass(frozen=True)
class EvenSpeed(CheckedFields):
    """The same `speed` [m/s] everywhere on the path."""

    speed: float


@dataclass(frozen=True)
class EvenTurns(CheckedFields):
    """The same number of `turns` a second [1/s] everywhere."""

    turns: float


@dataclass(frozen=True, eq=False)
class Spiral(CheckedFields):
    """r = b theta from nought to a `radius` [m], `pitch` = 2 pi b between turns [m], passed at a `pace`; there it stays.

    `ramp` [s] is how long speed (or the rate of turns) rises from nought, evenly, and falls at the end. The path's length is
    s = b/2 (theta (1 + theta^2)^(1/2) + arsinh theta); for even speed theta follows from it by Newton's method, to rounding.

    >>> spiral = Spiral(radius=10e-6, pitch=1e-6, pace=EvenTurns(10.0))
    >>> round(spiral.duration, 12), spiral.at(np.array([0.05, 9.0])).round(12).tolist()
    (1.0, [[-5e-07, 0.0], [1e-05, 0.0]])
    """

    radius: float
    pitch: float
    pace: EvenSpeed | EvenTurns
    ramp: float = 0.0
    start: float = 0.0
    coordinates: tuple[str, str] = ("x", "y")
    point: str = PLATFORM

    def __post_init__(self) -> None:
        super().__post_init__()
        """Refuse numbers that make no spiral, and ramps that it is too short for."""
        named = {"radius": self.radius, "pitch": self.pitch, "pace": self._pace}
        wrong = {name: value for name, value in named.items() if not 0.0 < value < np.inf}
        require(Finding(f"spiral: {name}", f"it is {value:g}", "Give a positive number") for name, value in wrong.items())
        if not 0.0 <= self.ramp <= self._whole / self._pace:
            what = f"{self.ramp:g} s, where the spiral takes {self._whole / self._pace:g} s at its full pace"
            require([Finding("spiral: ramp", what, "Shorten the ramp, or slow down")])

    @property
    def duration(self) -> float:
        """When it has reached its radius [s]."""
        return self.start + self._progress.duration

    def at(self, times: Array) -> Array:
        """Poses (n, 2) at `times` (n,) [s]."""
        passed = self._progress.at(np.asarray(times, dtype=float) - self.start)[:, 0]
        angle = _angle(passed / self._growth) if isinstance(self.pace, EvenSpeed) else passed
        return self._growth * angle[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    @property
    def _growth(self) -> float:
        """b, the growth of the radius per radian."""
        return self.pitch / (2.0 * np.pi)

    @property
    def _last(self) -> float:
        return self.radius / self._growth

    @property
    def _pace(self) -> float:
        """Full pace, of what `_whole` counts."""
        return self.pace.speed if isinstance(self.pace, EvenSpeed) else 2.0 * np.pi * self.pace.turns

    @property
    def _whole(self) -> float:
        """Length of the path [m], or the last angle [rad]."""
        return self._growth * float(_length(np.array(self._last))) if isinstance(self.pace, EvenSpeed) else self._last

    @cached_property
    def _progress(self) -> Pieces:
        """Length or angle passed over time: speeding up, even, slowing down."""
        pace, ramp = self._pace, self.ramp
        even, first = self._whole / pace - ramp, 0.5 * pace * ramp
        bend = 0.5 * pace / ramp if ramp else 0.0
        parts = [(ramp, [0.0, 0.0, bend]), (even, [first, pace, 0.0]), (ramp, [first + pace * even, pace, -bend])]
        return join((time, np.array([*values, 0.0, 0.0, 0.0])[:, None]) for time, values in parts)


def _length(angle: Array) -> Array:
    """Length of the path over b."""
    return 0.5 * (angle * np.sqrt(1.0 + angle**2) + np.arcsinh(angle))


def _angle(length: Array) -> Array:
    """Angles whose paths have these lengths over b: the length is convex and rising, so Newton's method from above cannot fail."""
    angle = np.minimum(np.sqrt(2.0 * length), length)
    for _ in range(20):
        angle = angle - (_length(angle) - length) / np.sqrt(1.0 + angle**2)
    return angle
