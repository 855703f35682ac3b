"""Piezo stack actuators."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from flexstage.base.digest import DOCUMENT_ONLY, Description
from flexstage.base.number import Number
from flexstage.base.quantity import (
    BENDING_RIGIDITY,
    CAPACITANCE,
    DISPLACEMENT,
    EXPANSION,
    FORCE,
    FREQUENCY,
    LENGTH,
    MASS,
    NOT_NEGATIVE,
    POSITIVE,
    RATIO,
    STIFFNESS,
    VOLTAGE,
)
from flexstage.parts.freedom import Freedom


@dataclass(frozen=True, eq=False)
class Piezo(Description):
    """A piezo stack along x: an axial spring with an imposed free stroke u (u > 0 expands), elsewhere the stiffness of its section.

    `stroke` is the full free stroke over the voltage range; `stiffness` the axial stiffness; `diameter` that of the ceramic. The
    ceramic's effective modulus follows, E = k L / A. `bending_rigidity` is the EI of the encapsulated stack where its casing stiffens
    it (absent: that of the ceramic). Blocking force = stroke x stiffness. `maximum_load` is compressive, `tensile_limit` without
    preload.
    """

    stroke: Annotated[Number, DISPLACEMENT, POSITIVE]
    stiffness: Annotated[Number, STIFFNESS, POSITIVE]
    length: Annotated[Number, LENGTH, POSITIVE]
    diameter: Annotated[Number, LENGTH, POSITIVE]
    poisson: Annotated[Number, RATIO] = 0.3
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    bending_rigidity: Annotated[Number, BENDING_RIGIDITY, POSITIVE] | None = None
    maximum_load: Annotated[Number, FORCE, POSITIVE] | None = None
    tensile_limit: Annotated[Number, FORCE, NOT_NEGATIVE] | None = None
    preload: Annotated[Number, FORCE, NOT_NEGATIVE] | None = None
    resonance: Annotated[Number, FREQUENCY, POSITIVE] | None = None
    voltage_low: Annotated[Number, VOLTAGE] | None = None
    voltage_high: Annotated[Number, VOLTAGE] | None = None
    bias: Annotated[Number, VOLTAGE] | None = None
    capacitance: Annotated[Number, CAPACITANCE, POSITIVE] | None = None
    expansion: Annotated[Number, EXPANSION] | None = None
    loss_factor: Annotated[Number, RATIO, NOT_NEGATIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """No passive freedom: the translation along x is the stroke."""
        return ()

    @property
    def blocking_force(self) -> Number:
        """Force of the fully driven stack held at its length: stroke x stiffness [N].

        >>> round(Piezo(stroke=150e-6, stiffness=17e6, length=0.162, diameter=0.01).blocking_force, 6)
        2550.0
        """
        return self.stroke * self.stiffness
