"""Tuning specification, and the result of a tuning."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from flexstage.analysis.dynamics.random_response import Spectrum
from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding
from flexstage.base.number import Array, Table
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.family import Family
from flexstage.control.controllers.lqg import LQG, Disturbances
from flexstage.control.controllers.notch import Notch
from flexstage.control.tuning.objective import SENSITIVITY, TuningObjective


@dataclass(frozen=True, eq=False)
class TuningSpec(CheckedFields):
    """Tuning specification: `family` of the controller, requirements, disturbances and references.

    Without an `objective`, every loop has its gain crossover at `bandwidth` [Hz] (default: the highest possible) and contains the specified
    `notches`. If `automatic`, further notches are placed on modes. With an objective, the controller is optimised. For every loop,
    `rejection` [Hz] is then the lowest permitted sensitivity crossover, and `settling` [s] is the longest permitted 2 % settling time
    (default of both: no limit). `overshoot` is the largest permitted overshoot of a step response. `delay_margin` [s] is the smallest
    permitted delay margin of a loop. With `prefilter`, prefilters shape the references.

    `sensitivity` is the highest permitted peak of the sensitivity; for this peak, rotations are multiplied by the stage's length. A peak of
    2 (6 dB) implies gain margins of 2 and phase margins of 29 deg (Skogestad & Postlethwaite, Multivariable Feedback Control, 2005,
    equation 2.47). Stability and peak must hold for relative shifts of all modes within +-`spread`. With an objective, stability and peak
    must also hold for relative errors of all gains within +-`gain`.

    `expected` are the disturbances that an observer assumes. `floor` contains the spectra of the floor motions. The matrix `feedforward`
    (n, f) multiplies the reference of f coordinates; the result is n feedforward strokes.
    """

    family: Family
    bandwidth: float | None = None
    sensitivity: float = SENSITIVITY
    spread: float = 0.02
    objective: TuningObjective | None = None
    rejection: float | None = None
    settling: float | None = None
    overshoot: float = 0.2
    delay_margin: float | None = None
    gain: float = 0.0
    prefilter: bool = False
    notches: tuple[Notch, ...] = ()
    automatic: bool = True
    expected: Disturbances | None = None
    floor: Mapping[str, Spectrum] = field(default_factory=lambda: Table({}))
    feedforward: Array | None = None


def spec_findings(spec: TuningSpec, step: float | None) -> Iterator[Finding]:
    """List the errors of a specification for a loop sampled every `step` [s].

    >>> from flexstage.control.tuning.laws import PI_FAMILY
    >>> [str(each) for each in spec_findings(TuningSpec(PI_FAMILY, 6000.0), 1e-4)]
    ['bandwidth: 6000 Hz is not below half the sampling rate, 5000 Hz. Sample above 60000 Hz, or use a lower bandwidth.']
    >>> [each.advice for each in spec_findings(TuningSpec(PI_FAMILY, rejection=500.0, delay_margin=1e-3), 1e-4)]
    ['Use a rejection below 159.2 Hz, or a delay margin below 0.3183 ms']
    """
    if spec.bandwidth is not None and not 0.0 < spec.bandwidth < np.inf:
        yield Finding("bandwidth", f"must be positive (got {spec.bandwidth:g} Hz)", "Use a positive frequency")
    elif spec.bandwidth is not None and step is not None and spec.bandwidth >= 0.5 / step:
        what = f"{spec.bandwidth:g} Hz is not below half the sampling rate, {0.5 / step:g} Hz"
        yield Finding("bandwidth", what, f"Sample above {10.0 * spec.bandwidth:g} Hz, or use a lower bandwidth")
    if not 1.0 < spec.sensitivity < np.inf:
        advice = "Use a larger value, e.g. 2 (6 dB): with delay, the peak of S always exceeds 1"
        yield Finding("sensitivity", f"the limit of the peak of S must be above 1 (got {spec.sensitivity:g})", advice)
    if not 0.0 <= spec.spread < 0.5:
        yield Finding("spread", f"the relative spread of the modes must be at least 0 and below 0.5 (got {spec.spread:g})", "Use e.g. 0.02")
    delay = spec.delay_margin or 0.0
    if spec.rejection is not None and step is not None and spec.rejection >= 0.5 / step:
        what = f"{spec.rejection:g} Hz is not below half the sampling rate, {0.5 / step:g} Hz"
        yield Finding("controller.goal.rejection", what, "Use a lower frequency, or sample faster")
    elif spec.rejection is not None and 2.0 * np.pi * spec.rejection * delay > 1.0:
        turn = f"at {spec.rejection:g} Hz, a delay of {1e3 * delay:g} ms is a phase lag of {360.0 * spec.rejection * delay:.0f} deg"
        what = f"{turn}: no loop with this rejection remains stable with this delay"
        least, most = 0.5 / (np.pi * delay), 0.5e3 / (np.pi * spec.rejection)
        yield Finding("controller.goal", what, f"Use a rejection below {least:.4g} Hz, or a delay margin below {most:.4g} ms")
    if spec.settling is not None and delay > 0.5 * spec.settling:
        what = f"a settling time of {1e3 * spec.settling:g} ms conflicts with a delay margin of {1e3 * delay:g} ms"
        yield Finding(
            "controller.goal",
            what,
            "Keep only one of these requirements: the delay margin of a loop is only a fraction of its settling time",
        )


@dataclass(frozen=True)
class Judgement:
    """Evaluation: `bandwidths` [Hz] by loop, `peak` sensitivity, its `frequency` [Hz], and the largest growth rate `growth` [1/s].

    The bandwidths belong to the nominal plant; `peak` and `growth` are the largest over the mode spread. `offset` is the mode shift with
    the highest peak or, in an unstable loop, with the largest growth; `frequency` belongs to this shift.
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
        """Score (smaller is better): the peak of the sensitivity, or a value above 1e9 for an unstable loop."""
        return self.peak if self.stable else 1e9 * (1.0 + self.growth)


@dataclass(frozen=True, eq=False)
class Tuning:
    """Tuned `controller`, its `spec` and its `judgement`; `reason` summarises the result."""

    spec: TuningSpec
    controller: Decentralised | LQG
    judgement: Judgement
    reason: str

    @property
    def bandwidth(self) -> float:
        """Bandwidth of the slowest loop [Hz]."""
        return min(self.judgement.bandwidths)
