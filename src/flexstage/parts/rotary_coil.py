"""Rotary voice coils: torque motors of limited angle, whose torque is proportional to the current."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Number
from flexstage.base.storage.digest import DOCUMENT_ONLY
from flexstage.base.units.quantity import (
    ANGLE,
    CURRENT,
    INDUCTANCE,
    MASS,
    MOMENT,
    NOT_NEGATIVE,
    POSITIVE,
    RATIO,
    RESISTANCE,
    ROTATIONAL_DAMPING,
    ROTATIONAL_STIFFNESS,
    TEMPERATURE,
    THERMAL_RESISTANCE,
    TORQUE_CONSTANT,
    VOLTAGE,
)
from flexstage.parts.voice_coil import DUTY, Coil, CoilSide, Supply


@dataclass(frozen=True, eq=False)
class RotaryCoil(Coil):
    """Rotary voice coil about x. The torque on the second body is `torque_constant` times current; the first body has the opposite torque.

    A positive torque turns the second body in the positive sense about x; a negative `torque_constant` reverses the sense. `stiffness` is
    the magnets' stiffness about x, `damping` the coil's damping about x. `angular_travel` is the whole angle over which the torque constant
    is valid. All other fields have the same meaning as in `VoiceCoil`. The masses are point masses: specify moments of inertia in the
    bodies.
    """

    kind: ClassVar[str] = "rotary_coil"
    axis: ClassVar[int] = 3
    torque_constant: Annotated[Number, TORQUE_CONSTANT]
    peak_current: Annotated[Number, CURRENT, POSITIVE] | None = None
    continuous_current: Annotated[Number, CURRENT, POSITIVE] | None = None
    voltage: Annotated[Number, VOLTAGE, POSITIVE] | None = None
    maximum_torque: Annotated[Number, MOMENT, POSITIVE] | None = None
    resistance: Annotated[Number, RESISTANCE, POSITIVE] | None = None
    inductance: Annotated[Number, INDUCTANCE, POSITIVE] | None = None
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    magnet_mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    coil: CoilSide = CoilSide.SECOND
    drive: Supply = Supply.CURRENT
    stiffness: Annotated[Number, ROTATIONAL_STIFFNESS] = 0.0
    damping: Annotated[Number, ROTATIONAL_DAMPING, NOT_NEGATIVE] = 0.0
    angular_travel: Annotated[Number, ANGLE, POSITIVE] | None = None
    thermal_resistance: Annotated[Number, THERMAL_RESISTANCE, POSITIVE] | None = None
    temperature_rise: Annotated[Number, TEMPERATURE, POSITIVE] | None = None
    duty: Annotated[Number, RATIO, DUTY] = 1.0
    source: str = field(default="", metadata=DOCUMENT_ONLY)

    @property
    def thrust(self) -> Number:
        """Torque per unit of input [N m/A]: the torque constant."""
        return self.torque_constant

    @property
    def travel(self) -> Number | None:  # type: ignore[override]
        """Angular travel [rad]."""
        return self.angular_travel

    @property
    def maximum(self) -> Number | None:
        """Largest torque [N m]."""
        return self.maximum_torque

    @property
    def mirrored(self) -> RotaryCoil:
        """The coil with the opposite torque constant, because a torque is an axial vector.

        >>> RotaryCoil(torque_constant=0.2).mirrored.torque_constant
        -0.2
        """
        return replace(self, torque_constant=-self.torque_constant)

    @property
    def faults(self) -> Iterator[Finding]:
        """Errors: as for every `Coil`, or a torque constant of zero."""
        yield from super().faults
        if not np.all(self.torque_constant):
            yield Finding("torque_constant", "must not be zero", 'Use e.g. "0.2 N m/A"')
