"""Raster scans: lines at constant speed, with reversals between them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.number import Array
from flexstage.control.trajectory.path import require_positive
from flexstage.control.trajectory.pieces import Pieces, join, rest, smooth, smooth_time

_STEEPEST = 10.0 / 3.0**0.5
"""Largest acceleration of a smooth move, times its time squared over its distance."""


@dataclass(frozen=True, eq=False)
class Raster(CheckedFields):
    """Raster of parallel lines, centred at zero: number `lines`, `length` and spacing `pitch` of the lines [m], constant `speed` [m/s].

    Reversals are outside the lines: the fast coordinate decelerates uniformly to the opposite speed, while the slow coordinate moves
    smoothly by the pitch. No acceleration exceeds `acceleration` [m/s^2]; a reversal lasts at least as long as the move by the pitch. The
    approach from 0 and the return to 0 are smooth. `overshoot` is the distance by which reversals exceed the lines.

    >>> raster = Raster(length=10e-6, pitch=1e-6, lines=3, speed=1e-3, acceleration=20.0)
    >>> round(raster.overshoot * 1e9, 6)  # turns are as slow as the step: 0.54 ms
    134.321241
    """

    length: float
    pitch: float
    lines: int
    speed: float
    acceleration: float
    coordinates: tuple[str, str] = ("x", "y")

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive("raster: ", {name: value for name, value in vars(self).items() if name != "coordinates"})

    @property
    def overshoot(self) -> float:
        """Distance [m] by which reversals exceed the lines: v^2/(2 a), with the line speed v and the deceleration a."""
        return 0.5 * self.speed**2 / self._swing

    @property
    def duration(self) -> float:
        """Time at which the path returns to zero [s]."""
        return self._pieces.duration

    @property
    def line_starts(self) -> Array:
        """Start times of the lines [s] (lines,); each line lasts length / speed."""
        entry = self._approach(self._first) + self.speed / self._swing
        return entry + np.arange(self.lines) * (self.length / self.speed + self._turn_time)

    @property
    def period(self) -> float:
        """Period [s] of the fast coordinate: one line forward and one line back."""
        return 2.0 * (self.length / self.speed + self._turn_time)

    @property
    def repeats(self) -> tuple[float, float]:
        """Start and end of the periodic section [s]: from the start of the first scan line to the end of the last scan line."""
        starts = self.line_starts
        return float(starts[0]), float(starts[-1]) + self.length / self.speed

    def at(self, times: Array) -> Array:
        """Compute poses (n, 2) [m, rad] at `times` (n,) [s], fast coordinate first."""
        return self._pieces.at(np.asarray(times, dtype=float))

    @property
    def _swing(self) -> float:
        """Acceleration of the fast coordinate in reversals: as specified, or lower if the slow move takes longer."""
        return min(self.acceleration, 2.0 * self.speed * (self.acceleration / (_STEEPEST * self.pitch)) ** 0.5)

    @property
    def _turn_time(self) -> float:
        """Time from the end of a line to the start of the next [s]."""
        return 2.0 * self.speed / self._swing

    @property
    def _first(self) -> Array:
        """Start time of the first line's run-up."""
        return np.array([-0.5 * self.length - self.overshoot, -0.5 * (self.lines - 1) * self.pitch])

    def _approach(self, place: Array) -> float:
        return smooth_time(float(np.max(np.abs(place))), self.speed, self.acceleration)

    @cached_property
    def _pieces(self) -> Pieces:
        return join(self._parts())

    def _parts(self) -> Iterator[tuple[float, Array]]:
        place, speed, accelerate = self._first, self.speed, self._swing
        yield self._approach(place), smooth(np.zeros(2), place, self._approach(place))
        yield _even_piece(place, 0.0, accelerate, speed / accelerate)
        for line in range(self.lines):
            sign = -1.0 if line % 2 else 1.0
            place = np.array([-0.5 * sign * self.length, self._first[1] + line * self.pitch])
            yield _even_piece(place, sign * speed, 0.0, self.length / speed)
            place = place * np.array([-1.0, 1.0])
            if line + 1 < self.lines:
                duration, coefficients = _even_piece(place, sign * speed, -sign * accelerate, self._turn_time)
                coefficients[:, 1] = smooth(place[1:], place[1:] + self.pitch, duration)[:, 0]
                yield duration, coefficients
            else:
                yield _even_piece(place, sign * speed, -sign * accelerate, speed / accelerate)
                place = place + np.array([sign * self.overshoot, 0.0])
        yield self._approach(place), smooth(place, np.zeros(2), self._approach(place))


def _even_piece(place: Array, speed: float, acceleration: float, time: float) -> tuple[float, Array]:
    """Piece of constant acceleration of the first coordinate."""
    coefficients = rest(place)
    coefficients[1, 0], coefficients[2, 0] = speed, 0.5 * acceleration
    return time, coefficients
