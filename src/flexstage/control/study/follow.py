"""Commanded path for a trajectory known in advance: by inversion, shaping or learning."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.control.learning.learn import LearningSettings, inverse_path, learn
from flexstage.control.learning.repeat import Repetition, repeat
from flexstage.control.learning.shaper import zv, zvd
from flexstage.control.simulation.result import Simulated
from flexstage.control.study.choices import Following
from flexstage.control.study.course import NamedTrajectory
from flexstage.control.study.disturbed import DisturbedLoop, part_of
from flexstage.control.study.setup import FollowSetup
from flexstage.control.systems.closed import Loop

_FEWEST = 2.0


def follow(
    asked: FollowSetup, closed: Loop, path: Array, course: NamedTrajectory, *, noisy: DisturbedLoop
) -> tuple[Simulated, dict[str, Any]]:
    """Simulate a path (n, f) with a tracking method, with rest before and after the path; also return the tracking fields of `Run`.

    Raises `DesignError` if the mode shifts leave no frequency band for inversion (see `robust_band`). The error is also raised if the
    path has fewer than two periods for repetitive control.
    """
    step = closed.step or 1.0
    around = round(noisy.rest / step)
    wanted = np.concatenate([np.zeros((around, path.shape[1])), path, np.tile(path[-1], (around, 1))])
    window, number, learned, repeated = slice(around, around + len(path)), asked.passes, None, None
    if asked.method is Following.REPETITIVE:
        repeated = repeat(noisy.begin(len(wanted)), closed, wanted, _repetition(asked, course, around, step))
        number, commanded = 0, repeated.commanded
    elif asked.method is Following.LEARNING:
        lesson = LearningSettings(asked.passes, asked.gain, asked.spread, window)
        learned = learn(lambda commanded, number: noisy.simulate(commanded, number).pose, closed, wanted, lesson)
        commanded = learned.commanded
    elif asked.method is Following.INVERSE:
        commanded = inverse_path(closed, wanted, asked.spread)
    else:
        shaper = (zv if asked.method is Following.ZV else zvd)(asked.frequency or 0.0, asked.damping)
        commanded = shaper.shape(wanted, step)
    whole = noisy.simulate(commanded, number)
    seen = part_of(noisy.machine, replace(whole, reference=wanted), window)
    return seen, {"commanded": commanded, "learned": learned, "repeated": repeated}


def _repetition(asked: FollowSetup, course: NamedTrajectory, around: int, step: float) -> Repetition:
    """Period of a trajectory, and its samples in repetition; raises `DesignError` for less than two periods."""
    period, (start, stop) = course.period or np.inf, course.repeats or (0.0, 0.0)
    count = (stop - start) / period
    if count < _FEWEST:
        what = f"the {course.name} has only {count:.3g} periods of {period:.4g} s, but repetitive control needs at least {_FEWEST:g}"
        raise refuse("follow", what, "Use more lines or periods: 6 periods remove most of the repeating error")
    window = slice(around + round(start / step), around + round(stop / step))
    return Repetition(period, window, asked.gain, asked.spread)
