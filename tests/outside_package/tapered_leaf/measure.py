"""How far a stage would sag, by its first frequency."""

from __future__ import annotations

from functools import partial

import numpy as np

from flexstage.analysis.assessment.measures import Measure, MeasureKind
from flexstage.analysis.bench import StageResults
from flexstage.base.number import Array
from flexstage.base.units.quantity import DISPLACEMENT


@partial(MeasureKind, "sag", DISPLACEMENT)
def sag(bench: StageResults, _: Measure) -> Array:
    """Static sag of the first mode under gravity along its motion.

    g / (2 pi f)^2 [m], with the first natural frequency f.
    """
    return 9.80665 / (2.0 * np.pi * bench.modes.frequencies[..., 0]) ** 2
