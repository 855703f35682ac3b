"""Voice coils: linear motors with a force proportional to the current."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Annotated, ClassVar, Self

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Number, magnitude
from flexstage.base.storage.digest import DOCUMENT_ONLY
from flexstage.base.units.quantity import (
    CURRENT,
    DISPLACEMENT,
    FORCE,
    FORCE_CONSTANT,
    INDUCTANCE,
    MASS,
    NOT_NEGATIVE,
    POSITIVE,
    RATIO,
    RESISTANCE,
    STIFFNESS,
    TEMPERATURE,
    THERMAL_RESISTANCE,
    VISCOUS_DAMPING,
    VOLTAGE,
    Bound,
)
from flexstage.parts.actuator import ForceLimit, ThrustActuator
from flexstage.parts.material import Material
from flexstage.parts.shape import Order
from flexstage.parts.stated import Stated, point_masses

DUTY = Bound(low=0.0, high=1.0, open_low=True)


class Supply(Enum):
    """Drive of the coil: a current amplifier, or a voltage amplifier; with a voltage amplifier, back-EMF adds damping."""

    CURRENT = "current"
    VOLTAGE = "voltage"


class CoilSide(Enum):
    """Body on which the coil is: the first or the second body in the `joins` of the link."""

    FIRST = "first"
    SECOND = "second"


class Coil(ThrustActuator):
    """Limits, heat and damping of a coil in the field of a magnet, with a force along x or a torque about x."""

    input = CURRENT
    peak_current: Number | None
    continuous_current: Number | None
    voltage: Number | None
    resistance: Number | None
    inductance: Number | None
    mass: Number
    magnet_mass: Number
    coil: CoilSide
    drive: Supply
    stiffness: Number
    damping: Number
    thermal_resistance: Number | None
    temperature_rise: Number | None
    duty: Number

    @property
    def maximum(self) -> Number | None:
        """Largest force [N] or torque [N m]."""
        raise NotImplementedError

    @property
    def viscous_damping(self) -> Number:
        """Damping along or about x [N s/m, N m s/rad]; a voltage drive adds the back-EMF term k_f^2 / R (see `VoiceCoil`).

        >>> VoiceCoil(force_constant=10.0, resistance=5.0, damping=1.0, drive=Supply.VOLTAGE).viscous_damping
        21.0
        """
        if self.drive is Supply.CURRENT or self.resistance is None:
            return self.damping
        return self.damping + self.thrust**2 / self.resistance

    def stated(self, material: Material | None = None) -> Stated:  # noqa: ARG002
        """Return the magnets' stiffness and the damping along or about x, and the masses of coil and magnet."""
        sides = (self.mass, self.magnet_mass)
        mass = point_masses(*(sides if self.coil is CoilSide.FIRST else sides[::-1]))
        own = np.diag(np.eye(6)[self.axis])
        stiffness, damping = (np.asarray(value)[..., None, None] * own for value in (self.stiffness, self.viscous_damping))
        return Stated(stiffness, mass, damping)

    @property
    def limits(self) -> Iterator[ForceLimit]:
        """Limits of the current, each for continuous and for short use."""
        yield ForceLimit("peak current", self.peak_current, self.peak_current)
        rested = self.duty**-0.5
        for name, held in (("continuous current", self.continuous_current), ("heat", self.heat_current)):
            if held is not None:
                yield ForceLimit(name, held, held * rested, clips=False)
        if self.voltage is not None and self.resistance is not None:
            yield ForceLimit("voltage", self.voltage / self.resistance, self.voltage / self.resistance)
        if self.maximum is not None:
            most = self.maximum / magnitude(self.thrust)
            yield ForceLimit(f"maximum {'torque' if self.axis else 'force'}", most, most)

    @property
    def cutoff(self) -> Number | None:
        """Cut-off frequency R / (2 pi L) of a voltage drive [Hz], with resistance R and inductance L; None for a current drive.

        >>> round(VoiceCoil(force_constant=10.0, resistance=6.0, inductance=1e-3, drive=Supply.VOLTAGE).cutoff, 1)
        954.9
        """
        if self.drive is Supply.CURRENT or self.resistance is None or self.inductance is None:
            return None
        return self.resistance / (2.0 * np.pi * self.inductance)

    def slew(self, limit: Number) -> Number | None:
        """Return the slew rate (V - R i / 2) / L [A/s] at half of the current `limit` i, without back-EMF; None without V or L.

        >>> VoiceCoil(force_constant=10.0, resistance=6.0, inductance=1e-3, voltage=24.0).slew(2.0)
        18000.0
        """
        if self.voltage is None or self.inductance is None:
            return None
        return (self.voltage - 0.5 * (self.resistance or 0.0) * limit) / self.inductance

    def in_series(self, count: int) -> Self:
        """Return the coil equivalent to `count` identical coils in series: resistance, inductance and heat add up.

        >>> pair = VoiceCoil(force_constant=10.0, resistance=5.0, thermal_resistance=4.0, temperature_rise=80.0).in_series(2)
        >>> pair.loss(1.0), pair.heat_current
        (10.0, 2.0)
        """
        total = {name: None if (own := getattr(self, name)) is None else count * own for name in ("resistance", "inductance")}
        thermal = None if self.thermal_resistance is None else self.thermal_resistance / count
        return replace(self, **total, thermal_resistance=thermal)  # type: ignore[type-var]

    def loss(self, rms: Number) -> Number | None:
        """Return the dissipated power i^2 R [W]; None without a resistance."""
        return None if self.resistance is None else rms**2 * self.resistance

    def warming(self, rms: Number) -> Number | None:
        """Return the temperature rise [K], i^2 R times the thermal resistance; None if a value is missing.

        >>> VoiceCoil(force_constant=10.0, resistance=5.0, thermal_resistance=4.0).warming(2.0)
        80.0
        """
        return None if self.resistance is None or self.thermal_resistance is None else rms**2 * self.resistance * self.thermal_resistance

    @property
    def heat_current(self) -> Number | None:
        """Direct current i [A] at which the heat i^2 R causes the largest permitted temperature rise; None if a value is missing.

        >>> VoiceCoil(force_constant=10.0, resistance=5.0, thermal_resistance=4.0, temperature_rise=80.0).heat_current
        2.0
        """
        if self.resistance is None or self.thermal_resistance is None or self.temperature_rise is None:
            return None
        return (self.temperature_rise / (self.thermal_resistance * self.resistance)) ** 0.5

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the continuous current does not exceed the peak current."""
        advice = "Exchange both values"
        yield Order("continuous_current", self.continuous_current, self.peak_current, "the peak current", advice, CURRENT, strict=False)

    @property
    def faults(self) -> Iterator[Finding]:
        """Errors: a voltage drive or a voltage limit without a resistance."""
        for name, asked in (("drive", self.drive is Supply.VOLTAGE), ("voltage", self.voltage is not None)):
            if asked and self.resistance is None:
                what = "resistance missing: it determines the current for a voltage"
                yield Finding(name, what, 'Add e.g. resistance = "5 ohm"')


@dataclass(frozen=True, eq=False)
class VoiceCoil(Coil):
    """Voice coil along x. The force between two bodies is `force_constant` times the current; a positive force pushes the bodies apart.

    `mass` is the coil's mass, on the body selected by `coil`; `magnet_mass` is the magnet's mass, on the other body. Both masses are point
    masses at the link's centre. `stiffness` is the magnets' stiffness along x (negative: the middle position is unstable). `damping` is the
    coil's damping, caused by eddy currents in its bobbin. With `drive` "voltage", back-EMF adds the damping k_f^2 / R, with the force
    constant k_f and the resistance R. `travel` is the range of motion along x over which `force_constant` is constant; half of the range is
    on each side of the middle.

    `temperature_rise` is the largest permitted temperature difference between coil and surroundings; `thermal_resistance` is the thermal
    resistance between them. `duty` is the duty cycle of the current in short use: the permitted short-time current is the continuous limit
    divided by the square root of `duty`. The input is the static (steady-state) current. With a voltage drive, the voltage V causes the
    static current V/R.

    The model neglects saturation, the change of R with temperature, and the lag of the current with a voltage drive. This lag has the time
    constant L/R, with the inductance L, and is significant above the frequency R / (2 pi L).
    """

    kind: ClassVar[str] = "voice_coil"
    force_constant: Annotated[Number, FORCE_CONSTANT, POSITIVE]
    peak_current: Annotated[Number, CURRENT, POSITIVE] | None = None
    continuous_current: Annotated[Number, CURRENT, POSITIVE] | None = None
    voltage: Annotated[Number, VOLTAGE, POSITIVE] | None = None
    maximum_force: Annotated[Number, FORCE, POSITIVE] | None = None
    resistance: Annotated[Number, RESISTANCE, POSITIVE] | None = None
    inductance: Annotated[Number, INDUCTANCE, POSITIVE] | None = None
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    magnet_mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    coil: CoilSide = CoilSide.SECOND
    drive: Supply = Supply.CURRENT
    stiffness: Annotated[Number, STIFFNESS] = 0.0
    damping: Annotated[Number, VISCOUS_DAMPING, NOT_NEGATIVE] = 0.0
    travel: Annotated[Number, DISPLACEMENT, POSITIVE] | None = None
    thermal_resistance: Annotated[Number, THERMAL_RESISTANCE, POSITIVE] | None = None
    temperature_rise: Annotated[Number, TEMPERATURE, POSITIVE] | None = None
    duty: Annotated[Number, RATIO, DUTY] = 1.0
    source: str = field(default="", metadata=DOCUMENT_ONLY)

    @property
    def thrust(self) -> Number:
        """Force constant [N/A]."""
        return self.force_constant

    @property
    def maximum(self) -> Number | None:
        """Largest force [N]."""
        return self.maximum_force
