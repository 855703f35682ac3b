"""Time-optimal rest-to-rest motion profiles with limited speed, acceleration and jerk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.control.trajectory.path import require_positive
from flexstage.control.trajectory.pieces import Pieces, join


@dataclass(frozen=True)
class Limits(CheckedFields):
    """Limits of a move along its path: `speed` [m/s], `acceleration` [m/s^2], `jerk` [m/s^3]; with rad instead of m for pure rotations."""

    speed: float
    acceleration: float
    jerk: float


def profile(distance: float, limits: Limits) -> Pieces:
    """Compute the time-optimal move over a `distance` [m, rad] within `limits`: jerk +j, 0, -j, constant speed, then -j, 0, +j.

    The durations t_j of constant jerk, t_a of constant acceleration and t_v of constant speed are computed in this order (Biagiotti and
    Melchiorri, Trajectory Planning for Automatic Machines and Robots, 2008, section 3.4). The first is t_j = min(a/j, (v/j)^(1/2),
    (d/(2 j))^(1/3)), with the limits v of speed, a of acceleration and j of jerk, and the distance d. Raises `DesignError` for limits that
    are not positive and finite.

    >>> move = profile(1.0, Limits(speed=1e9, acceleration=1e9, jerk=32.0))  # jerk alone counts: 4 (d/2j)^(1/3)
    >>> move.duration, move.at(np.array([0.5, 1.0])).ravel().tolist()
    (1.0, [0.5, 1.0])
    """
    require_positive("limits: ", vars(limits))
    jerk = limits.jerk
    short = min(limits.acceleration / jerk, (limits.speed / jerk) ** 0.5, (0.5 * distance / jerk) ** (1.0 / 3.0))
    top = jerk * short
    for_distance = 0.5 * (np.sqrt(short**2 + 4.0 * distance / top) - 3.0 * short)
    even = max(0.0, min(limits.speed / top - short, for_distance))
    speed = top * (short + even)
    steady = max(0.0, distance / speed - (2.0 * short + even))
    times = np.array([short, even, short, steady, short, even, short])
    return _integrate(times, jerk * np.array([1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0]), distance)


def _integrate(times: np.ndarray, jerks: np.ndarray, distance: float) -> Pieces:
    """Cubic pieces from jerks; the last value is set to the distance, which rounding misses by about 1e-16."""
    position = speed = acceleration = 0.0
    parts = []
    for time, jerk in zip(times, jerks, strict=True):
        parts.append((float(time), np.array([position, speed, acceleration / 2.0, jerk / 6.0, 0.0, 0.0])[:, None]))
        position += time * (speed + time * (acceleration / 2.0 + time * jerk / 6.0))
        speed += time * (acceleration + time * jerk / 2.0)
        acceleration += time * jerk
    scaled = [(time, coefficients * (distance / position)) for time, coefficients in parts]
    return join(scaled)
