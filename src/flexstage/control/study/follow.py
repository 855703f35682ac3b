"""A course as it is commanded where the path is known beforehand: inverted, shaped or learned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.control.closed import Loop
from flexstage.control.learning.learn import Learned, Lesson, inverse_path, learn
from flexstage.control.learning.shaper import zv, zvd
from flexstage.control.simulation.result import Simulated
from flexstage.control.study.choices import Following
from flexstage.control.study.setup import FollowSetup
from flexstage.control.system import System


@dataclass(frozen=True, eq=False)
class Followed:
    """A simulation whose reference is the path that was wanted, and what was learned of it."""

    simulated: Simulated
    learned: Learned | None


def follow(
    asked: FollowSetup, closed: Loop, control: System, path: Array, *, rest: float, run: Callable[[Array, int], Simulated]
) -> Followed:
    """A path (n, f) as a set-up wants it followed; `run` simulates what is commanded in a pass, `rest` [s] is left around it.

    Raises `DesignError` where the loop is not known well enough to be inverted at any frequency.
    """
    step = closed.step or 1.0
    around = round(rest / step)
    wanted = np.concatenate([np.zeros((around, path.shape[1])), path, np.tile(path[-1], (around, 1))])
    window = slice(around, around + len(path))
    learned = None
    if asked.by is Following.LEARNING:
        lesson = Lesson(asked.passes, asked.gain, asked.spread, window)
        learned = learn(lambda commanded, number: run(commanded, number).pose, closed, control, wanted, lesson)
        commanded = learned.commanded
    elif asked.by is Following.INVERSE:
        commanded = inverse_path(closed, control, wanted, asked.spread)
    else:
        shaper = (zv if asked.by is Following.ZV else zvd)(asked.frequency or 0.0, asked.damping)
        commanded = shaper.shape(wanted, step)
    return Followed(_against(run(commanded, asked.passes), wanted, window), learned)


def _against(found: Simulated, wanted: Array, window: slice) -> Simulated:
    """The window of a simulation, its errors against the path that was wanted."""
    whole = replace(found, reference=wanted, error=wanted - found.pose)
    names = [field.name for field in fields(Simulated) if np.shape(getattr(whole, field.name))[:1] == whole.times.shape]
    kept = {name: getattr(whole, name)[window] for name in names}
    return replace(whole, **(kept | {"times": whole.times[window] - whole.times[window.start]}))
