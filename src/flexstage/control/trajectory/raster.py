"""Rasters: lines at even speed, turned around between them or flown back."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.control.trajectory.pieces import Pieces, join, smooth, smooth_time
from flexstage.mechanism.mechanism import PLATFORM

_STEEPEST = 10.0 / 3.0**0.5
"""Largest acceleration of a smooth move, times its time squared over its distance."""


class Scan(Enum):
    """In which direction lines are passed."""

    BOTH_WAYS = "both ways"
    """Every other line is passed backwards: a triangle with rounded turns."""
    ONE_WAY = "one way"
    """After each line it flies back to the start of the next."""


@dataclass(frozen=True, eq=False)
class Raster(CheckedFields):
    """`lines` parallel lines of a `length`, `pitch` apart [m], around nought, each passed at an even `speed` [m/s].

    Turns lie outside the lines: the fast coordinate is decelerated evenly to the opposite speed, while the slow one steps smoothly by
    the pitch; nothing exceeds `acceleration` [m/s^2], and turns last as long as the step takes at least. One way, it flies back at up to
    `back` [m/s] (absent: twice the speed). It is approached from nought and left to nought smoothly. `overshoot` is the room turns need
    beyond the lines. Raises `DesignError` where the step of the pitch takes longer than flying back.

    >>> raster = Raster(length=10e-6, pitch=1e-6, lines=3, speed=1e-3, acceleration=20.0)
    >>> round(raster.overshoot * 1e9, 6)  # turns are as slow as the step: 0.54 ms
    134.321241
    """

    length: float
    pitch: float
    lines: int
    speed: float
    acceleration: float
    scan: Scan = Scan.BOTH_WAYS
    back: float | None = None
    start: float = 0.0
    coordinates: tuple[str, str] = ("x", "y")
    point: str = PLATFORM

    def __post_init__(self) -> None:
        super().__post_init__()
        """Refuse numbers that make no raster, and pitches that turns have no time for."""
        named = {"length": self.length, "pitch": self.pitch, "lines": self.lines, "speed": self.speed, "acceleration": self.acceleration}
        positive = {name: value for name, value in named.items() if not 0.0 < value < np.inf}
        require(Finding(f"raster: {name}", f"it is {value:g}", "Give a positive number") for name, value in positive.items())
        needed = _STEEPEST * self.pitch / self._turn_time**2
        if needed > self.acceleration * (1.0 + 1e-9):
            what = f"the step of {self.pitch:g} m within {self._turn_time:g} s of flying back takes {needed:g} m/s^2"
            require([Finding("raster: pitch", what, f"Fly back more slowly, or allow more than {self.acceleration:g} m/s^2")])

    @property
    def overshoot(self) -> float:
        """How far turns reach beyond the lines [m]: v^2 / 2 a."""
        return 0.5 * self.speed**2 / self._swing

    @property
    def duration(self) -> float:
        """When it is back at nought [s]."""
        return self.start + self._pieces.duration

    @property
    def line_starts(self) -> Array:
        """When each line begins [s] (lines,); it lasts length / speed."""
        steps = self._entry + np.arange(self.lines) * (self.length / self.speed + self._turn_time)
        return self.start + steps

    @property
    def period(self) -> float:
        """After this time [s] it does the same again, but for steps of the slow coordinate: a line to and a line fro, or one flown back."""
        return (2.0 if self.scan is Scan.BOTH_WAYS else 1.0) * (self.length / self.speed + self._turn_time)

    @property
    def repeats(self) -> tuple[float, float]:
        """From when to when it does [s]: from the begin of the first line to the end of the last."""
        starts = self.line_starts
        return float(starts[0]), float(starts[-1]) + self.length / self.speed

    def at(self, times: Array) -> Array:
        """Poses (n, 2) at `times` (n,) [s], fast coordinate first."""
        return self._pieces.at(np.asarray(times, dtype=float) - self.start)

    @property
    def _swing(self) -> float:
        """Acceleration of the fast coordinate in turns: as stated, or less where the step of the slow one takes longer."""
        if self.scan is Scan.ONE_WAY:
            return self.acceleration
        return min(self.acceleration, 2.0 * self.speed * (self.acceleration / (_STEEPEST * self.pitch)) ** 0.5)

    @property
    def _back(self) -> float:
        """Speed of flying back: as stated, or what the length gives time for."""
        wanted = 2.0 * self.speed if self.back is None else self.back
        return min(wanted, float(np.sqrt(self.speed**2 + self.acceleration * self.length)))

    @property
    def _even_back(self) -> float:
        """How long it flies back at even speed [s]."""
        return max(0.0, (self.length + (self.speed**2 - self._back**2) / self.acceleration) / self._back)

    @property
    def _turn_time(self) -> float:
        """From the end of a line to the start of the next [s]."""
        if self.scan is Scan.BOTH_WAYS:
            return 2.0 * self.speed / self._swing
        return 2.0 * (self.speed + self._back) / self.acceleration + self._even_back

    @property
    def _first(self) -> Array:
        """Where the run-up to the first line begins."""
        return np.array([-0.5 * self.length - self.overshoot, -0.5 * (self.lines - 1) * self.pitch])

    @property
    def _entry(self) -> float:
        """When the first line begins [s], from the start."""
        return self._approach(self._first) + self.speed / self._swing

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
            sign = -1.0 if self.scan is Scan.BOTH_WAYS and line % 2 else 1.0
            place = np.array([-0.5 * sign * self.length, self._first[1] + line * self.pitch])
            yield _even_piece(place, sign * speed, 0.0, self.length / speed)
            place = place * np.array([-1.0, 1.0])
            if line + 1 < self.lines:
                yield from self._turn(place, sign)
            else:
                yield _even_piece(place, sign * speed, -sign * accelerate, speed / accelerate)
                place = place + np.array([sign * self.overshoot, 0.0])
        yield self._approach(place), smooth(place, np.zeros(2), self._approach(place))

    def _turn(self, place: Array, sign: float) -> Iterator[tuple[float, Array]]:
        """Fast pieces of a turn from `place`, the slow coordinate's one smooth step cut to them."""
        speed, accelerate, step = self.speed, sign * self._swing, smooth(np.zeros(1), np.array([self.pitch]), self._turn_time)
        if self.scan is Scan.BOTH_WAYS:
            parts = [(sign * speed, -accelerate, self._turn_time)]
        else:
            swing = (speed + self._back) / self.acceleration
            parts = [(speed, -accelerate, swing), (-self._back, 0.0, self._even_back), (-self._back, accelerate, swing)]
        fast, passed = place[0], 0.0
        for rate, bend, time in parts:
            duration, coefficients = _even_piece(np.array([fast, place[1]]), rate, bend, time)
            coefficients[:, 1] = _shift_polynomial(step[:, 0], passed)
            coefficients[0, 1] += place[1]
            yield duration, coefficients
            fast, passed = fast + rate * time + 0.5 * bend * time**2, passed + time


def _even_piece(place: Array, speed: float, acceleration: float, time: float) -> tuple[float, Array]:
    """A piece of even speed and acceleration of the first coordinate."""
    coefficients = np.zeros((6, len(place)))
    coefficients[0] = place
    coefficients[1, 0], coefficients[2, 0] = speed, 0.5 * acceleration
    return time, coefficients


def _shift_polynomial(coefficients: Array, by: float) -> Array:
    """The coefficients of p(t + by)."""
    polynomial = np.polynomial.Polynomial(coefficients)
    moved = polynomial(np.polynomial.Polynomial([by, 1.0])).coef
    return np.concatenate([moved, np.zeros(6 - len(moved))])
