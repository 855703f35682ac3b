"""Linear encoders."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.storage.digest import DOCUMENT_ONLY
from flexstage.base.units.quantity import DISPLACEMENT, FREQUENCY, NOISE_DENSITY, NOT_NEGATIVE, POSITIVE, RATIO
from flexstage.parts.gauge import Instrument


@dataclass(frozen=True, eq=False)
class Encoder(Instrument):
    """Linear encoder: measures the displacement of a body's scale along the gauge's x axis, positive along +x.

    `range` is the total travel of the scale. Each `period` of the scale is divided into `steps`; with `steps` 1, a step is one period.
    `noise_density` is the amplitude density of white noise [m/Hz^0.5], `bandwidth` the measurement bandwidth [Hz]. Rotation of the scale
    has no first-order effect on the measurement.
    """

    kind: ClassVar[str] = "encoder"
    range: Annotated[Number, DISPLACEMENT, POSITIVE]
    period: Annotated[Number, DISPLACEMENT, POSITIVE]
    steps: Annotated[Number, RATIO, POSITIVE] = 1.0
    noise_density: Annotated[Number, NOISE_DENSITY, NOT_NEGATIVE] | None = None
    bandwidth: Annotated[Number, FREQUENCY, POSITIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)

    @property
    def resolution(self) -> Number:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Step [m].

        >>> Encoder(range=20e-3, period=8e-6, steps=2048.0).resolution
        3.90625e-09
        """
        return self.period / self.steps
