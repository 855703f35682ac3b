"""Tuning specification, and the result of a tuning."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.family import Family
from flexstage.control.controllers.lqg import LQG
from flexstage.control.controllers.notch import Notch


class Kind(Enum):
    """Kinds of controllers that can be tuned."""

    PI = "PI"
    PID = "PID"
    RESONANT = "integral resonant control"
    LQG = "LQG"


@dataclass(frozen=True)
class TuningSpec(CheckedFields):
    """Specification of a tuning: `bandwidth` [Hz], where every loop's gain first passes 1; absent: the highest that the rest allows.

    `sensitivity` is the highest peak of S allowed (poses as lengths): 2 = 6 dB leaves gain margins of 2 and phase margins of 29 deg
    (Skogestad & Postlethwaite, Multivariable Feedback Control, 2005, eq. 2.47). `spread` is how much all modes may lie above or below the
    model's, relative: stability and peak hold there too.
    """

    bandwidth: float | None = None
    sensitivity: float = 2.0
    spread: float = 0.02


def spec_findings(spec: TuningSpec, step: float | None) -> Iterator[Finding]:
    """List the errors of a specification for a loop sampled every `step` [s].

    >>> [str(each) for each in spec_findings(TuningSpec(6000.0), 1e-4)]
    ['bandwidth: 6000 Hz is not below half the sampling rate, 5000 Hz. Sample above 60000 Hz, or ask for less.']
    """
    if spec.bandwidth is not None and not 0.0 < spec.bandwidth < np.inf:
        yield Finding("bandwidth", f"it is {spec.bandwidth:g} Hz", "Give a positive frequency")
    elif spec.bandwidth is not None and step is not None and spec.bandwidth >= 0.5 / step:
        what = f"{spec.bandwidth:g} Hz is not below half the sampling rate, {0.5 / step:g} Hz"
        yield Finding("bandwidth", what, f"Sample above {10.0 * spec.bandwidth:g} Hz, or ask for less")
    if not 1.0 < spec.sensitivity < np.inf:
        advice = "Give more, for example 2 (6 dB): no loop with a delay stays at 1"
        yield Finding("sensitivity", f"the highest peak of S allowed is {spec.sensitivity:g}, and it has to be above 1", advice)
    if not 0.0 <= spec.spread < 0.5:
        yield Finding("spread", f"modes are to be off by up to {spec.spread:g}", "Give a ratio from 0 to 0.5, for example 0.02")


@dataclass(frozen=True)
class Judgement:
    """A loop as it came out: `bandwidths` [Hz] by loop, the `peak` of S and where [Hz], `growth` [1/s] of its slowest free motion.

    All are the worst over the modes' spread, the bandwidths those of the model itself. `offset` tells where the peak or, in an unstable
    loop, the growth was found: modes by this much above the model's.
    """

    bandwidths: tuple[float, ...]
    peak: float
    frequency: float
    growth: float
    offset: float

    @property
    def stable(self) -> bool:
        """Whether all free motions decay."""
        return self.growth < 0.0

    @property
    def score(self) -> float:
        """The smaller the better: the peak of S; above 1e9 for unstable loops."""
        return self.peak if self.stable else 1e9 * (1.0 + self.growth)


@dataclass(frozen=True, eq=False)
class Tuning:
    """A tuned controller: its `kind`, the `spec`, its `judgement`, and the `notches` of each loop; `reason` is the sentence."""

    kind: Kind | Family
    spec: TuningSpec
    controller: Decentralised | LQG
    judgement: Judgement
    notches: tuple[tuple[Notch, ...], ...]
    reason: str

    @property
    def bandwidth(self) -> float:
        """Bandwidth of the slowest loop [Hz]."""
        return min(self.judgement.bandwidths)
