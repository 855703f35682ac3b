"""Trajectories of a set-up in a stage's coordinates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.analysis.workspace.polytope import reachable
from flexstage.analysis.workspace.stroke import StrokeLimits
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW
from flexstage.base.units.quantity import TIME
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.study.setup import AxisAmplitudes, RasterMotion, SineMotion, SpiralMotion, StepMotion, TrajectorySetup
from flexstage.control.trajectory.check import reach_findings, speed_findings
from flexstage.control.trajectory.path import Trajectory, reference
from flexstage.control.trajectory.profile import Limits
from flexstage.control.trajectory.raster import Raster
from flexstage.control.trajectory.sine import Sine
from flexstage.control.trajectory.spiral import Spiral
from flexstage.control.trajectory.step import Step
from flexstage.control.trajectory.table import from_file
from flexstage.spatial.frame import COMPONENTS

_LENGTH, _ANGLE = 1e-6, 10e-6
_FADED = 0.5
"""Periods over which a sine amplitude increases."""
_RAMP = 0.1
_MOST_SAMPLES = 5_000_000


@dataclass(frozen=True, eq=False)
class NamedTrajectory:
    """Named trajectory; `plane` are the two coordinates of a plan view.

    The trajectory is periodic with `period` [s] between the start and end times `repeats` [s] (default: not periodic). It is truncated at
    `end` [s].
    """

    name: str
    trajectory: Annotated[Trajectory, INNER]
    plane: Annotated[tuple[str, str] | None, INNER] = None
    period: Annotated[float | None, INNER] = None
    repeats: Annotated[tuple[float, float] | None, INNER] = None
    end: Annotated[float, INNER] = np.inf

    @property
    def moved(self) -> Annotated[tuple[str, ...], VIEW]:
        """Moved coordinates."""
        return self.trajectory.coordinates

    @property
    def duration(self) -> Annotated[float, TIME]:
        """Duration [s]."""
        return min(self.trajectory.duration, self.end)

    @property
    def is_step(self) -> bool:
        """Whether the trajectory is a step, which is evaluated by its settling."""
        return isinstance(self.trajectory, Step)


def courses(commanded: TrajectorySetup, coordinates: Coordinates) -> tuple[NamedTrajectory, ...]:
    """Construct the trajectories of a set-up for a loop of these coordinates; a step becomes one trajectory per coordinate.

    Raises `DesignError` for unknown coordinates and invalid numbers.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.control.plant_models.coordinates import coordinates
    >>> from flexstage.models.ideal import ideal
    >>> found = courses(StepMotion(), coordinates(ideal(parallelogram())))
    >>> [(each.name, each.trajectory.at(np.array([1.0])).tolist()) for each in found]
    [('x', [[1e-06]])]
    """
    found = tuple(_courses(commanded, coordinates))
    require(
        Finding(f"trajectory {each.name}", f"the stage has no motion {name}", suggest_nearest(name, coordinates.names))
        for each in found
        for name in each.trajectory.coordinates
        if name not in coordinates.names
    )
    return found


def _courses(commanded: TrajectorySetup, coordinates: Coordinates) -> Iterator[NamedTrajectory]:
    if isinstance(commanded, StepMotion):
        for name, size in (stated_motions(commanded.amplitude) or _default_motions(coordinates.names)).items():
            step = Step({name: size}, limits=_limits(commanded))
            yield NamedTrajectory(name, step)
    elif isinstance(commanded, RasterMotion):
        pair = (commanded.fast.value, commanded.slow.value)
        sizes = (commanded.length, commanded.pitch, commanded.lines, commanded.speed, commanded.acceleration)
        raster = Raster(*sizes, coordinates=pair)
        yield NamedTrajectory("raster", raster, pair, raster.period, raster.repeats)
    elif isinstance(commanded, SpiralMotion):
        pair = (commanded.first.value, commanded.second.value)
        way = np.pi * commanded.radius**2 / commanded.pitch
        ramp = min(_RAMP, 0.2 * way / commanded.speed)
        spiral = Spiral(commanded.radius, commanded.pitch, commanded.speed, ramp, coordinates=pair)
        yield NamedTrajectory("spiral", spiral, pair)
    elif isinstance(commanded, SineMotion):
        sizes = stated_motions(commanded.amplitude) or dict([next(iter(_default_motions(coordinates.names).items()))])
        sine = Sine(sizes, commanded.frequency, fade=_FADED / commanded.frequency)
        period, end = 1.0 / commanded.frequency, commanded.periods / commanded.frequency
        yield NamedTrajectory("sine", sine, None, period, (_FADED * period, end), end)
    else:
        table = from_file(commanded.file)
        first, *others = [name for name in table.coordinates if not name.startswith("r")] or [""]
        yield NamedTrajectory("file", table, (first, others[0]) if others else None)


def stated_motions(by: AxisAmplitudes) -> dict[str, float]:
    """Return the specified amplitudes [m, rad] by coordinate.

    >>> stated_motions(AxisAmplitudes(x=1e-6))
    {'x': 1e-06}
    """
    return {name: getattr(by, name) for name in COMPONENTS if getattr(by, name) is not None}


def _default_motions(names: tuple[str, ...]) -> dict[str, float]:
    return {name: _ANGLE if name.startswith("r") else _LENGTH for name in names}


def _limits(commanded: StepMotion) -> Limits | None:
    if commanded.speed is None or commanded.acceleration is None or commanded.jerk is None:
        return None
    return Limits(commanded.speed, commanded.acceleration, commanded.jerk)


def sampled_course(course: NamedTrajectory, coordinates: Coordinates, step: float, seconds: float) -> tuple[Array, Array]:
    """Sample a trajectory every `step` [s], for a duration of `seconds`. Returns times (n,) [s] and poses (n, f) [m, rad].

    Raises `DesignError` for a duration too short or too long to simulate.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.control.plant_models.coordinates import coordinates
    >>> from flexstage.models.ideal import ideal
    >>> loop = coordinates(ideal(parallelogram()))
    >>> times, poses = sampled_course(courses(StepMotion(), loop)[0], loop, 1e-3, 0.1)
    >>> len(times), poses.shape
    (100, (100, 1))
    """
    count = round(seconds / step)
    if not 2 <= count <= _MOST_SAMPLES:
        what = f"wrong number of samples (got {float(count):.7g} for {seconds:g} s at {1.0 / step:g} Hz, expected 2 to {_MOST_SAMPLES})"
        require([Finding("seconds", what, "Change the duration (seconds) or the sampling rate")])
    times = step * np.arange(count)
    return times, reference(course.trajectory, coordinates.names, times)


def course_findings(course: NamedTrajectory, poses: Array, times: Array, gains: Matrix, limits: StrokeLimits) -> list[Finding]:
    """Check a trajectory against the stroke limits; `gains` map commanded poses to strokes.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.control.plant_models.coordinates import coordinates
    >>> from flexstage.analysis.workspace.stroke import stroke_limits
    >>> from flexstage.models.ideal import ideal
    >>> stage = parallelogram()
    >>> loop = coordinates(ideal(stage))
    >>> far = courses(StepMotion(amplitude=AxisAmplitudes(x=1e-3)), loop)[0]
    >>> found = course_findings(far, np.array([[1e-3]]), np.zeros(1), ideal(stage).mapping, stroke_limits(stage))
    >>> found[0].where, "beyond the strokes" in found[0].what
    ('trajectory x', True)
    """
    found = reach_findings(poses, times, reachable(gains, limits)) if np.all(np.isfinite(limits.full)) else []
    return [Finding(f"trajectory {course.name}", each.what, each.advice) for each in found]


def course_warnings(
    course: NamedTrajectory, poses: Array, times: Array, gains: Matrix, slew: Array, *, units: tuple[str, ...] = ()
) -> list[Finding]:
    """Warn if a trajectory other than a step exceeds the rate limits `slew` (m,) of the amplifiers, which then saturate."""
    if course.is_step or not np.any(np.isfinite(slew)):
        return []
    found = speed_findings(poses, times, gains, slew, units=units)
    return [Finding(f"trajectory {course.name}: {each.where}", each.what, each.advice) for each in found]
