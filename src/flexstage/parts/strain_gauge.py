"""Strain gauges on stacks and other links."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.storage.digest import DOCUMENT_ONLY
from flexstage.base.units.quantity import DISPLACEMENT, FREQUENCY, NOISE_DENSITY, NOT_NEGATIVE, POSITIVE
from flexstage.parts.gauge import Instrument


@dataclass(frozen=True, eq=False)
class StrainGauge(Instrument):
    """Strain gauge on a link: elongation between the link's faces, including the free stroke if the link is a piezo stack.

    All values are elongations, not strains. `range` is the total measuring span [m], `resolution` the quantisation step [m],
    `noise_density` the amplitude density of white noise [m/Hz^0.5], and `bandwidth` the measurement bandwidth [Hz].
    """

    kind: ClassVar[str] = "strain"
    inside: ClassVar[bool] = True
    range: Annotated[Number, DISPLACEMENT, POSITIVE]
    resolution: Annotated[Number, DISPLACEMENT, NOT_NEGATIVE] = 0.0
    noise_density: Annotated[Number, NOISE_DENSITY, NOT_NEGATIVE] | None = None
    bandwidth: Annotated[Number, FREQUENCY, POSITIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)
