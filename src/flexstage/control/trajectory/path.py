"""What every trajectory is: poses over time; poses as a loop's reference."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.number import Array


class Trajectory(Protocol):
    """Poses over time: `at(times)` in m and rad, of the platform, in the stage's axes and counted from where the stage rests.

    A trajectory rests at nought before it starts. `duration` is when the last motion ends [s].
    """

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates that move, of x, y, z, rx, ry, rz."""
        ...

    @property
    def duration(self) -> float:
        """When the last motion ends [s]."""
        ...

    def at(self, times: Array) -> Array:
        """Poses (n, c) at `times` (n,) [s]."""
        ...


def require_positive(where: str, numbers: Mapping[str, float | None]) -> None:
    """Refuse what is stated and not above 0, or not finite."""
    wrong = {name: value for name, value in numbers.items() if value is not None and not 0.0 < value < np.inf}
    require(Finding(f"{where}{name}", f"it is {value:g}", "Give a positive number") for name, value in wrong.items())


@check_arguments
def reference(trajectory: Trajectory, coordinates: Sequence[str], times: Array) -> Array:
    """The reference poses (n, f) of a loop of these coordinates at `times` (n,); coordinates that do not move are 0.

    Raises `DesignError` for coordinates the loop does not have.

    >>> from flexstage.control.trajectory.step import Step
    >>> up = Step({"z": 2e-6}, start=1.0)
    >>> reference(up, ("x", "z"), np.array([0.0, 1.0])).tolist()
    [[0.0, 0.0], [0.0, 2e-06]]
    """
    advice = "The loop's coordinates are " + ", ".join(coordinates)
    require(
        Finding(f"trajectory: {name}", "unknown coordinate", f"{suggest_nearest(name, coordinates)}. {advice}")
        for name in trajectory.coordinates
        if name not in coordinates
    )
    poses = np.zeros((len(times), len(coordinates)))
    poses[:, [coordinates.index(name) for name in trajectory.coordinates]] = trajectory.at(np.asarray(times, dtype=float))
    return poses
