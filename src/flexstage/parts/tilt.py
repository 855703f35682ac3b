"""Tilt gauges (autocollimators, angle interferometers)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.storage.digest import DOCUMENT_ONLY
from flexstage.base.units.quantity import FREQUENCY, NOT_NEGATIVE, POSITIVE, ROTATION, ROTATION_NOISE
from flexstage.parts.freedom import Freedom
from flexstage.parts.gauge import Instrument


@dataclass(frozen=True, eq=False)
class Tilt(Instrument):
    """Tilt gauge: right-handed rotation of a body about the gauge's x axis. The gauge's position has no effect.

    `range` is the total measuring span [rad], `resolution` the quantisation step [rad], `noise_density` the amplitude density of white
    noise [rad/Hz^0.5], and `bandwidth` the measurement bandwidth [Hz].
    """

    kind: ClassVar[str] = "tilt"
    freedom: ClassVar[Freedom] = Freedom.RX
    range: Annotated[Number, ROTATION, POSITIVE]
    resolution: Annotated[Number, ROTATION, NOT_NEGATIVE] = 0.0
    noise_density: Annotated[Number, ROTATION_NOISE, NOT_NEGATIVE] | None = None
    bandwidth: Annotated[Number, FREQUENCY, POSITIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)
