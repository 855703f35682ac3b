"""What every trajectory is: poses over time at a stated point, and how fast they change; poses as a loop's reference."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.mechanism.mechanism import PLATFORM


class Trajectory(Protocol):
    """Poses over time: `at(times)` in m and rad, of the named `point`, in the stage's axes and counted from where the stage rests.

    A trajectory rests at nought before it starts. `duration` is when the last motion ends [s].
    """

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates that move, of x, y, z, rx, ry, rz."""
        ...

    @property
    def point(self) -> str:
        """The point of the platform whose pose is meant."""
        ...

    @property
    def duration(self) -> float:
        """When the last motion ends [s]."""
        ...

    def at(self, times: Array) -> Array:
        """Poses (n, c) at `times` (n,) [s]."""
        ...


@check_arguments
def reference(trajectory: Trajectory, coordinates: Sequence[str], times: Array, motion: Matrix | None = None) -> Array:
    """The poses (n, f) a loop of these coordinates is asked for at `times` (n,); coordinates that do not move are nought.

    `motion` (rows: the point's coordinates, columns: the loop's) is the point's pose per pose of the loop, xi = motion^-1 pose; absent
    where the loop's coordinates are the point's own. Raises `DesignError` for coordinates the loop does not have, for a point without
    `motion` and for one whose motions are not independent.

    >>> from flexstage.control.trajectory.step import Step
    >>> up = Step({"z": 2e-6}, start=1.0)
    >>> reference(up, ("x", "z"), np.array([0.0, 1.0])).tolist()
    [[0.0, 0.0], [0.0, 2e-06]]
    """
    known = tuple(coordinates) if motion is None else motion.rows
    advice = "The loop's coordinates are " + ", ".join(known)
    require(
        Finding(f"trajectory: {name}", "the loop has no coordinate of this name", f"{suggest_nearest(name, known)}. {advice}")
        for name in trajectory.coordinates
        if name not in known
    )
    if motion is None and trajectory.point != PLATFORM:
        raise refuse(f"trajectory at {trajectory.point}", "how this point moves with the platform is not given", "Give its motion")
    poses = np.zeros((len(times), len(known)))
    poses[:, [known.index(name) for name in trajectory.coordinates]] = trajectory.at(np.asarray(times, dtype=float))
    return poses if motion is None else np.linalg.solve(_independent(motion, trajectory.point), poses.T).T


def _independent(motion: Matrix, point: str) -> Array:
    values = np.asarray(motion.values)
    if values.shape[0] != values.shape[1] or np.linalg.cond(values) > 1e9:
        what = f"its motions along {', '.join(motion.rows)} do not determine {', '.join(motion.columns)}"
        raise refuse(f"trajectory at {point}", what, "Choose another point")
    return values
