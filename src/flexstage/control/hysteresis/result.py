"""Identified hysteresis: the model, its accuracy, and the samples used."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Graded, Heading
from flexstage.base.units.quantity import LENGTH, PIEZO_GAIN, VOLTAGE
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.hysteresis.models.shape import Range

SMALL_ERROR = Graded(0.02)


@dataclass(frozen=True)
class Trial:
    """Tried model size (numbers of `plays` and of envelope `pieces`, and `reach`), with its error.

    All thresholds are below `reach` times the voltage range. `error` is the cross-validation error, divided by the stroke. Several fits
    each exclude one part of the record; the rms error is computed over the excluded parts.
    """

    plays: int
    pieces: int
    reach: float
    error: float


@dataclass(frozen=True, eq=False)
class Plays:
    """Play model of a stack: thresholds and weights (n,), and knots and values of the envelopes `before` (V to V) and `after` (m to m)."""

    thresholds: Annotated[Array, VOLTAGE, Heading("threshold")]
    weights: Annotated[Array, PIEZO_GAIN, Heading("weight", digits=4)]
    before: Annotated[tuple[Array, Array], VIEW]
    after: Annotated[tuple[Array, Array], VIEW]

    @property
    def slopes(self) -> Annotated[Array, INNER, PIEZO_GAIN, Heading("sum of weights", digits=4)]:
        """Slopes (n,) [m/V] of the virgin curve beyond each threshold."""
        return np.cumsum(self.weights)


@dataclass(frozen=True, eq=False)
class IdentifiedHysteresis(InNotebook):
    """Hysteresis model identified from a record, with its accuracy.

    Errors and drift are divided by `stroke` [m], the range of the strokes after the first branch. `rms` and `largest` are the rms error and
    the largest error from sample `known_from` on; these samples do not depend on the unknown history. `validation` is the rms error on
    parts of the record that were not fitted. `width` is the largest distance between the branches of the model's major loop, divided by
    that loop's stroke. `range` is the recorded voltage range; `inner` is the number of branches shorter than 80 % of the recorded range.
    `volts`, `strokes` and `modelled` (k,) are the samples used.
    """

    model: Annotated[PrandtlIshlinskii, INNER]
    range: Annotated[Range, VOLTAGE, Heading("voltage range")]
    stroke: Annotated[float, LENGTH, Heading(varying=True)]
    rms: Annotated[float, Heading("rms error", digits=3, unit="%", mark=SMALL_ERROR)]
    largest: Annotated[float, Heading("largest error", digits=3, unit="%", mark=Graded(0.1))]
    validation: Annotated[float, Heading("rms error, validation", digits=3, unit="%", mark=SMALL_ERROR)]
    width: Annotated[float, Heading("loop width", digits=3, unit="%")]
    drift: Annotated[float, Heading(digits=3, unit="%")]
    branches: int
    inner: Annotated[int, Heading("inner branches")]
    known_from: int
    trials: tuple[Trial, ...]
    warnings: Annotated[tuple[Finding, ...], INNER]
    volts: Array
    strokes: Array
    modelled: Array

    @property
    def plays(self) -> Annotated[Plays, VIEW]:
        """The identified plays."""
        before, after = self.model.before, self.model.after
        ends = [(each.knots[0], each.values[0]) for each in (before, after)]
        return Plays(self.model.thresholds[0], self.model.weights[0], *ends)
