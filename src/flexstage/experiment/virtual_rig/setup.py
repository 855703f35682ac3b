"""Set-up of a virtual test: noise, amplifier, filter, gauges, sampling."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from flexstage.base.arguments import CheckedFields
from flexstage.base.units.quantity import (
    CURRENT,
    DISPLACEMENT,
    FORCE,
    FREQUENCY,
    MOMENT,
    NOISE_DENSITY,
    NOT_NEGATIVE,
    POSITIVE,
    TIME,
    VOLTAGE,
)
from flexstage.experiment.virtual_rig.inputs import InputQuantity, InputSignal
from flexstage.parts.amplifier import Amplifier


@dataclass(frozen=True)
class NoiseDrive(CheckedFields):
    """Drive of the actuators by Gaussian noise, independent for each actuator.

    `stroke` [m] and `voltage` [V] are the rms of a stack's commanded free stroke or voltage. `current` [A], `force` [N] or `torque` [N m]
    is the rms of a force actuator's input. The default is 1 % of a stack's full stroke, or of a force actuator's sustained input limit.

    The density is constant within `band` (low, high) [Hz], by default 0 to 0.4 times the sampling rate. The density decays to zero from
    `low` to `low`/2 and from `high` to 1.25 `high`. `actuators` names the driven and recorded actuators (default: all).
    """

    stroke: Annotated[float, DISPLACEMENT, POSITIVE] | None = None
    voltage: Annotated[float, VOLTAGE, POSITIVE] | None = None
    current: Annotated[float, CURRENT, POSITIVE] | None = None
    force: Annotated[float, FORCE, POSITIVE] | None = None
    torque: Annotated[float, MOMENT, POSITIVE] | None = None
    band: tuple[Annotated[float, FREQUENCY, NOT_NEGATIVE], Annotated[float, FREQUENCY, POSITIVE]] | None = None
    actuators: tuple[str, ...] | None = None

    @property
    def amounts(self) -> dict[InputQuantity, float]:
        """Specified rms values by quantity.

        >>> NoiseDrive(current=0.1).amounts
        {<InputQuantity.CURRENT: 'current'>: 0.1}
        """
        return {quantity: value for quantity in InputQuantity if (value := getattr(self, quantity.value)) is not None}


@dataclass(frozen=True)
class AntiAlias(CheckedFields):
    """Anti-alias Butterworth filter of every analogue channel: `order` (0: none), `corner` [Hz] (default: 0.4 times the rate)."""

    order: int = 8
    corner: Annotated[float, FREQUENCY, POSITIVE] | None = None


@dataclass(frozen=True)
class Sensing(CheckedFields):
    """Errors of gauges: white noise of `density` [m/Hz^0.5], quantisation in steps of `resolution` [m], and `drift`.

    By default, `density` and `resolution` are the values of each gauge in the design. The drift is a random walk with standard deviation
    `drift` [m] after a minute. `density`, `resolution` and `drift` apply to displacement gauges. Rotation gauges have the design's values,
    without drift.
    """

    density: Annotated[float, NOISE_DENSITY, NOT_NEGATIVE] | None = None
    resolution: Annotated[float, DISPLACEMENT, NOT_NEGATIVE] | None = None
    drift: Annotated[float, DISPLACEMENT, NOT_NEGATIVE] = 0.0


@dataclass(frozen=True)
class RigSetup(CheckedFields):
    """Virtual test: `seconds` long, sampled at `rate` [Hz], with the random numbers of `seed`; readings are recorded `delay` [s] late.

    A test is refused if its peaks exceed the amplifier's largest output current, because a saturated amplifier is not linear. The default
    rate is the lowest power of two that is at least ten times the frequency of the highest platform mode. Equal set-ups of equal stages
    give bit-identical records. Without `input_quantity`, each recorded input is the actuator's input quantity: stroke, current or force.

    >>> RigSetup(seconds=10.0).filter.order
    8
    """

    seconds: Annotated[float, TIME, POSITIVE]
    rate: Annotated[float, FREQUENCY, POSITIVE] | None = None
    seed: int = 0
    drive: NoiseDrive = field(default_factory=NoiseDrive)
    amplifier: Amplifier = field(default_factory=Amplifier)
    filter: AntiAlias = field(default_factory=AntiAlias)
    sensing: Sensing = field(default_factory=Sensing)
    input_signal: InputSignal = InputSignal.MONITOR
    input_quantity: InputQuantity | None = None
    delay: Annotated[float, TIME, NOT_NEGATIVE] = 0.0
