"""Displacement gauges (capacitive gap sensors)."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Annotated

from flexstage.base.digest import DOCUMENT_ONLY, Description
from flexstage.base.number import Number
from flexstage.base.quantity import DISPLACEMENT, FREQUENCY, NOISE_DENSITY, NOT_NEGATIVE, POSITIVE


class Positive(Enum):
    """What makes a gauge's reading grow: the gap opens or the gap closes."""

    OPENS = "opens"
    CLOSES = "closes"


@dataclass(frozen=True, eq=False)
class Gauge(Description):
    """A displacement gauge: measuring `range` (total span), `resolution` (quantisation step), white `noise_density`, `bandwidth`."""

    range: Annotated[Number, DISPLACEMENT, POSITIVE]
    resolution: Annotated[Number, DISPLACEMENT, NOT_NEGATIVE] = 0.0
    noise_density: Annotated[Number, NOISE_DENSITY, NOT_NEGATIVE] | None = None
    bandwidth: Annotated[Number, FREQUENCY, POSITIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)
