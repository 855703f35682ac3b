"""How far a stage would sag, by its first frequency."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.judge import Bench
from flexstage.analysis.offered import OfferedMeasure
from flexstage.base.number import Array
from flexstage.base.quantity import DISPLACEMENT


def sag(bench: Bench) -> Array:
    """g / (2 pi f)^2 of the first natural frequency f [m]."""
    return 9.80665 / (2.0 * np.pi * bench.modes.frequencies[..., 0]) ** 2


SAG = OfferedMeasure("sag of the first mode if it stood upright", DISPLACEMENT, sag)
