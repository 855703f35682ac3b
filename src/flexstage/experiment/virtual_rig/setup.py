"""How a virtual test is set up: noise, amplifier, filter, gauges, clock. Light: the command line names the choices without loading more."""

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
    """Gaussian noise that drives the actuators, each its own.

    `stroke` is the rms of the commanded free stroke [m], `voltage` that of the command [V], `current` [A], `force` [N] or `torque` [N m]
    that of a force actuator's input. Without any, it is 1 % of each full stroke, or of the largest sustained input of a force actuator.
    The density is flat within `band` (low, high) [Hz] and falls to zero from `low` to `low`/2 and from `high` to 1.25 `high` (absent: 0
    to 0.4 times the sampling rate). `actuators` names those that are driven (absent: all); only they are recorded.
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
        """The specified rms values by quantity.

        >>> NoiseDrive(current=0.1).amounts
        {<InputQuantity.CURRENT: 'current'>: 0.1}
        """
        return {quantity: value for quantity in InputQuantity if (value := getattr(self, quantity.value)) is not None}


@dataclass(frozen=True)
class AntiAlias(CheckedFields):
    """Butterworth filter of every recorded analogue channel: `order` (0: none) and `corner` [Hz] (absent: 0.4 times the sampling rate)."""

    order: int = 8
    corner: Annotated[float, FREQUENCY, POSITIVE] | None = None


@dataclass(frozen=True)
class Sensing(CheckedFields):
    """What gauges add: white noise of `density` [m/Hz^0.5], steps of `resolution` [m], and `drift`.

    Where absent, density and resolution are those each gauge of the design states (none stated: none). `drift` is a random walk, its
    standard deviation after a minute [m]. They are those of displacement gauges: gauges of rotations have what they state, and no drift.
    """

    density: Annotated[float, NOISE_DENSITY, NOT_NEGATIVE] | None = None
    resolution: Annotated[float, DISPLACEMENT, NOT_NEGATIVE] | None = None
    drift: Annotated[float, DISPLACEMENT, NOT_NEGATIVE] = 0.0


@dataclass(frozen=True)
class RigSetup(CheckedFields):
    """A test: `seconds` long, sampled at `rate` [Hz], with the random numbers of `seed`; gauges are recorded `delay` [s] late.

    A test whose peaks ask for more than the amplifier's current is refused, since a saturated amplifier is not linear.
    Without a rate it is the least power of two that is ten times the highest platform mode. The same set-up of the same stage gives
    the same record, to the bit. Without `input_quantity`, each recorded input is the actuator's own: stroke, current or force.

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
