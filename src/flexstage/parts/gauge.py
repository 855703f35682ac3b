"""Displacement gauges (capacitive gap sensors)."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Annotated, ClassVar

from flexstage.base.digest import DOCUMENT_ONLY, Description
from flexstage.base.number import Number
from flexstage.base.quantity import DISPLACEMENT, FREQUENCY, NOISE_DENSITY, NOT_NEGATIVE, POSITIVE


class Positive(Enum):
    """What makes a gauge's reading grow: the gap opens or the gap closes."""

    OPENS = "opens"
    CLOSES = "closes"


class DisplacementGauge(Description):
    """What every `kind` of gauge has, as fields or worked out of them; `parts.GAUGES` lists the kinds.

    Measuring `range` (total span) and `resolution` (quantisation step) [m], white `noise_density` [m/Hz^0.5] and `bandwidth` [Hz]; the
    last two are `None` where they are unknown.
    """

    kind: ClassVar[str]
    range: Number
    resolution: Number
    noise_density: Number | None
    bandwidth: Number | None


@dataclass(frozen=True, eq=False)
class Gauge(DisplacementGauge):
    """A displacement gauge: measuring `range` (total span), `resolution` (quantisation step), white `noise_density`, `bandwidth`."""

    kind: ClassVar[str] = "gauge"
    range: Annotated[Number, DISPLACEMENT, POSITIVE]
    resolution: Annotated[Number, DISPLACEMENT, NOT_NEGATIVE] = 0.0
    noise_density: Annotated[Number, NOISE_DENSITY, NOT_NEGATIVE] | None = None
    bandwidth: Annotated[Number, FREQUENCY, POSITIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)
