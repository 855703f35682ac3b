"""An interferometer: fringes that are counted in steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import DISPLACEMENT, FREQUENCY, POSITIVE, RATIO
from flexstage.parts.gauge import DisplacementGauge


@dataclass(frozen=True, eq=False)
class Interferometer(DisplacementGauge):
    """Interferometer with the range `travel`; a `fringe` has several `steps`."""

    kind: ClassVar[str] = "interferometer"
    travel: Annotated[Number, DISPLACEMENT, POSITIVE]
    fringe: Annotated[Number, DISPLACEMENT, POSITIVE]
    steps: Annotated[Number, RATIO, POSITIVE]
    bandwidth: Annotated[Number, FREQUENCY, POSITIVE] | None = None

    @property
    def range(self) -> Number:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Total travel."""
        return self.travel

    @property
    def resolution(self) -> Number:  # pyright: ignore[reportIncompatibleVariableOverride]
        """One step."""
        return self.fringe / self.steps

    @property
    def noise_density(self) -> Number | None:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Not known."""
        return None
