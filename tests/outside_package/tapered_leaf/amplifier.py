"""A kind of amplifier: switching, as fast as a tenth of its carrier."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from flexstage.base.units.quantity import FREQUENCY, POSITIVE
from flexstage.control.plant_models.electronics import AmplifierSettings
from flexstage.control.study.hardware.amplifiers import AmplifierForm


@dataclass(frozen=True)
class Switching(AmplifierForm):
    """Amplifier that switches at the `carrier` frequency."""

    kind: ClassVar[str] = "switching"
    carrier: Annotated[float, FREQUENCY, POSITIVE] = 100e3

    @property
    def settings(self) -> AmplifierSettings:
        """First-order lag at a tenth of the carrier frequency."""
        return AmplifierSettings(bandwidth=0.1 * self.carrier)
