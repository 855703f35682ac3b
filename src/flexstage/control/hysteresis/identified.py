"""An identified hysteresis: the model, how well it fits, and what of the actuator's range its record shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.control.hysteresis.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.hysteresis.shape import Range


@dataclass(frozen=True)
class Trial:
    """A size of model that was tried: `plays`, `pieces` of the envelope, `reach` of the thresholds (part of the range), and its error.

    `error` is the rms error on the parts of the record that were kept from the fit, each once, as a part of the stroke.
    """

    plays: int
    pieces: int
    reach: float
    error: float


@dataclass(frozen=True, eq=False)
class IdentifiedHysteresis(InNotebook):
    """A model identified from a record, and how well it fits.

    Errors and the width are parts of `stroke` [m], the range of the strokes after the first branch.
    `rms` and `largest` are errors over the samples after `known_from`, where nothing depends on the unknown past any more; `validation`
    is the rms error on parts of the record that were not fitted. `width` is the largest distance of the branches of the model's major
    loop. `range` are the volts covered, `inner` the number of branches that are shorter than 80 % of it. `volts`, `strokes` and
    `modelled` (k,) are the samples used.
    """

    model: PrandtlIshlinskii
    range: Range
    stroke: float
    rms: float
    largest: float
    validation: float
    width: float
    drift: float
    branches: int
    inner: int
    known_from: int
    trials: tuple[Trial, ...]
    cautions: tuple[str, ...]
    volts: Array
    strokes: Array
    modelled: Array

    def to_json(self) -> dict[str, Any]:
        """The result as {range_v, stroke_m, rms, largest, validation, width, drift, branches, inner, trials, cautions, model}."""
        return {
            "range_v": list(self.range),
            "stroke_m": self.stroke,
            "rms": self.rms,
            "largest": self.largest,
            "validation": self.validation,
            "width": self.width,
            "drift": self.drift,
            "branches": self.branches,
            "inner": self.inner,
            "trials": [[each.plays, each.pieces, each.reach, each.error] for each in self.trials],
            "cautions": list(self.cautions),
            "model": {
                "thresholds_v": self.model.thresholds[0].tolist(),
                "weights_m_per_v": self.model.weights[0].tolist(),
                "before": [self.model.before.knots[0].tolist(), self.model.before.values[0].tolist()],
                "after": [self.model.after.knots[0].tolist(), self.model.after.values[0].tolist()],
            },
        }
