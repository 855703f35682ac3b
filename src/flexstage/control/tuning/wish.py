"""What a search shall reach."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding
from flexstage.control.tuning.aim import Aim

STABLE = 2.5
"""Modes may be off by so many times the spread before the loop may become unstable."""


@dataclass(frozen=True)
class Wish:
    """What a controller shall be best at, `objective`, and what it has to keep.

    `sensitivity` is the highest peak of S, coupled, allowed wherever all modes lie within `spread` (relative), and whatever every gain is
    within `gain` (relative); modes may be off by 2.5 times the spread before the loop becomes unstable. `delay_margin` [s] is what every
    loop keeps, `overshoot` the most of a step. `rejection` [Hz] and `settling` [s] (to 2 %) are wanted of every loop; absent: as good as it
    gets. `prefilter`: whether references are shaped besides.
    """

    objective: Aim = Aim.BALANCE
    sensitivity: float = 2.0
    spread: float = 0.02
    gain: float = 0.0
    delay_margin: float = 0.0
    overshoot: float = 0.2
    rejection: float | None = None
    settling: float | None = None
    prefilter: bool = False


def wish_findings(wish: Wish, step: float | None) -> Iterator[Finding]:
    """What contradicts itself, for a loop sampled every `step` [s].

    >>> [each.advice for each in wish_findings(Wish(rejection=500.0, delay_margin=1e-3), 1e-4)]
    ['Ask for less than 159.2 Hz, or 0.3183 ms']
    """
    if wish.rejection is not None and step is not None and wish.rejection >= 0.5 / step:
        what = f"{wish.rejection:g} Hz is not below half the sampling rate, {0.5 / step:g} Hz"
        yield Finding("controller.goal.rejection", what, "Ask for less, or sample faster")
    elif wish.rejection is not None and 2.0 * np.pi * wish.rejection * wish.delay_margin > 1.0:
        turn = 360.0 * wish.rejection * wish.delay_margin
        delay = f"a delay of {1e3 * wish.delay_margin:g} ms turns by {turn:.0f} deg"
        what = f"up to {wish.rejection:g} Hz {delay}: no loop that rejects so far bears it"
        least, most = 0.5 / (np.pi * wish.delay_margin), 0.5e3 / (np.pi * wish.rejection)
        yield Finding("controller.goal", what, f"Ask for less than {least:.4g} Hz, or {most:.4g} ms")
    if wish.settling is not None and wish.delay_margin > 0.5 * wish.settling:
        what = f"steps are to settle in {1e3 * wish.settling:g} ms, and a delay of {1e3 * wish.delay_margin:g} ms is to be borne"
        yield Finding("controller.goal", what, "Ask for one of them: a loop bears a fraction of what it settles in")
