"""Protocol of trajectories (poses over time), and the reference of a loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.number import Array


class Trajectory(Protocol):
    """Platform poses over time, relative to the static equilibrium: `at(times)` in m and rad, in the stage's axes.

    A trajectory starts at rest at zero. `duration` is the end of the last motion [s].
    """

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the moving coordinates: x, y, z, rx, ry or rz."""
        ...

    @property
    def duration(self) -> float:
        """End of the last motion [s]."""
        ...

    def at(self, times: Array) -> Array:
        """Compute poses (n, c) [m, rad] at `times` (n,) [s]."""
        ...


def require_positive(where: str, numbers: Mapping[str, float]) -> None:
    """Raise `DesignError` for values that are not positive and finite."""
    require(
        Finding(f"{where}{name}", f"must be positive (got {value:g})", "Use a positive, finite number")
        for name, value in numbers.items()
        if not 0.0 < value < np.inf
    )


@check_arguments
def reference(trajectory: Trajectory, coordinates: Sequence[str], times: Array) -> Array:
    """Evaluate the reference poses (n, f) of a loop with these `coordinates` at `times` (n,); coordinates without motion are 0.

    Raises `DesignError` if the trajectory moves other coordinates than those of the loop.

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
