"""Specification of optimisation-based tuning."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding
from flexstage.control.tuning.objective import TuningObjective

STABLE = 2.5
"""Modes may be off by so many times the spread before the loop may become unstable."""


@dataclass(frozen=True)
class SearchSpec:
    """Specification of optimisation-based tuning: the `objective` of the controller, and the limits that it keeps.

    `sensitivity` is the highest peak of S, coupled, allowed wherever all modes lie within `spread` (relative), and whatever every gain is
    within `gain` (relative); modes may be off by 2.5 times the spread before the loop becomes unstable. `delay_margin` [s] is what every
    loop keeps, `overshoot` the most of a step. `rejection` [Hz] and `settling` [s] (to 2 %) apply to every loop; absent: as good as it
    gets. `prefilter`: whether references are shaped besides.
    """

    objective: TuningObjective = TuningObjective.BALANCE
    sensitivity: float = 2.0
    spread: float = 0.02
    gain: float = 0.0
    delay_margin: float = 0.0
    overshoot: float = 0.2
    rejection: float | None = None
    settling: float | None = None
    prefilter: bool = False


def search_findings(spec: SearchSpec, step: float | None) -> Iterator[Finding]:
    """What contradicts itself, for a loop sampled every `step` [s].

    >>> [each.advice for each in search_findings(SearchSpec(rejection=500.0, delay_margin=1e-3), 1e-4)]
    ['Ask for less than 159.2 Hz, or 0.3183 ms']
    """
    if spec.rejection is not None and step is not None and spec.rejection >= 0.5 / step:
        what = f"{spec.rejection:g} Hz is not below half the sampling rate, {0.5 / step:g} Hz"
        yield Finding("controller.goal.rejection", what, "Ask for less, or sample faster")
    elif spec.rejection is not None and 2.0 * np.pi * spec.rejection * spec.delay_margin > 1.0:
        turn = 360.0 * spec.rejection * spec.delay_margin
        delay = f"a delay of {1e3 * spec.delay_margin:g} ms turns by {turn:.0f} deg"
        what = f"up to {spec.rejection:g} Hz {delay}: no loop that rejects so far bears it"
        least, most = 0.5 / (np.pi * spec.delay_margin), 0.5e3 / (np.pi * spec.rejection)
        yield Finding("controller.goal", what, f"Ask for less than {least:.4g} Hz, or {most:.4g} ms")
    if spec.settling is not None and spec.delay_margin > 0.5 * spec.settling:
        what = f"steps are to settle in {1e3 * spec.settling:g} ms, and a delay of {1e3 * spec.delay_margin:g} ms is to be borne"
        yield Finding("controller.goal", what, "Ask for one of them: a loop bears a fraction of what it settles in")
