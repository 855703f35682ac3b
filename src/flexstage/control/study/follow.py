"""A course as it is commanded where the path is known beforehand: inverted, shaped or learned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.control.learning.learn import Learned, Lesson, inverse_path, learn
from flexstage.control.learning.repeat import Repeated, Repetition, repeat
from flexstage.control.learning.shaper import zv, zvd
from flexstage.control.simulation.result import Simulated
from flexstage.control.study.choices import Following
from flexstage.control.study.course import Course
from flexstage.control.study.setup import FollowSetup
from flexstage.control.systems.closed import Loop
from flexstage.control.systems.system import System

_FEWEST = 2.0


@dataclass(frozen=True, eq=False)
class Followed:
    """A simulation whose reference is the path that was wanted, and what was learned of it, or while it ran."""

    simulated: Simulated
    commanded: Array
    learned: Learned | None = None
    repeated: Repeated | None = None


@dataclass(frozen=True, eq=False)
class Runner:
    """How a path is run: `whole` simulates what is commanded in a pass of that number.

    `begin` makes a loop of so many samples that runs on by what is commanded and tells the pose, in the noise of pass 0.
    """

    whole: Callable[[Array, int], Simulated]
    begin: Callable[[int], Callable[[Array], Array]]


def follow(asked: FollowSetup, closed: Loop, control: System, path: Array, course: Course, *, rest: float, runner: Runner) -> Followed:
    """A path (n, f) of a course as a set-up wants it followed; `rest` [s] is left around it.

    Raises `DesignError` where the loop is not known well enough to be inverted at any frequency.
    """
    step = closed.step or 1.0
    around = round(rest / step)
    wanted = np.concatenate([np.zeros((around, path.shape[1])), path, np.tile(path[-1], (around, 1))])
    window = slice(around, around + len(path))
    if asked.method is Following.REPETITIVE:
        repetition = _repetition(course, around, step)
        seen = repeat(runner.begin(len(wanted)), closed, control, wanted, repetition, gain=asked.gain, spread=asked.spread)
        return Followed(_against(runner.whole(seen.commanded, 0), wanted, window), seen.commanded, repeated=seen)
    learned = None
    if asked.method is Following.LEARNING:
        lesson = Lesson(asked.passes, asked.gain, asked.spread, window)
        learned = learn(lambda commanded, number: runner.whole(commanded, number).pose, closed, control, wanted, lesson)
        commanded = learned.commanded
    elif asked.method is Following.INVERSE:
        commanded = inverse_path(closed, control, wanted, asked.spread)
    else:
        shaper = (zv if asked.method is Following.ZV else zvd)(asked.frequency or 0.0, asked.damping)
        commanded = shaper.shape(wanted, step)
    return Followed(_against(runner.whole(commanded, asked.passes), wanted, window), commanded, learned)


def _repetition(course: Course, around: int, step: float) -> Repetition:
    """The period of a course, and where in its samples it repeats; raises `DesignError` where that is less than two periods long."""
    period, (start, stop) = course.period or np.inf, course.repeats or (0.0, 0.0)
    count = (stop - start) / period
    if count < _FEWEST:
        what = f"the {course.name} repeats {count:.3g} times every {period:.4g} s, and what is learned in one period acts in the next"
        raise refuse("follow", what, "Take more lines or periods: 6 periods leave little of what repeats")
    return Repetition(period, slice(around + round(start / step), around + round(stop / step)))


def _against(found: Simulated, wanted: Array, window: slice) -> Simulated:
    """The window of a simulation, its errors against the path that was wanted."""
    whole = replace(found, reference=wanted, error=wanted - found.pose)
    names = [field.name for field in fields(Simulated) if np.shape(getattr(whole, field.name))[:1] == whole.times.shape]
    kept = {name: getattr(whole, name)[window] for name in names}
    return replace(whole, **(kept | {"times": whole.times[window] - whole.times[window.start]}))
