"""Piezo stack actuators."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.storage.digest import DOCUMENT_ONLY
from flexstage.base.units.quantity import (
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
from flexstage.parts.actuator import ChargedActuator
from flexstage.parts.section import Circle, circle
from flexstage.parts.shape import Order, Shaped


@dataclass(frozen=True, eq=False)
class Piezo(ChargedActuator, Shaped):
    """Piezo stack along x: an axial spring with an imposed free stroke u (u > 0 expands).

    `stroke` is the full free stroke over the voltage range, `stiffness` the axial stiffness k, and `diameter` the diameter of the ceramic.
    The other stiffness terms follow from the ceramic's section area A, the length L and the effective modulus k L / A. `bending_rigidity`
    is the bending rigidity of a stack stiffened by its casing (default: the bending rigidity of the ceramic alone). The blocked force is
    the product of stroke and stiffness. `maximum_load` is the largest compression and `tensile_limit` the largest tension in the stack. The
    force in the stack is the sum of load and `preload`.
    """

    kind: ClassVar[str] = "piezo"
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
    def blocking_force(self) -> Number:
        """Blocked force [N]: product of the full free stroke and the stiffness.

        >>> round(Piezo(stroke=150e-6, stiffness=17e6, length=0.162, diameter=0.01).blocking_force, 6)
        2550.0
        """
        return self.stroke * self.stiffness

    @property
    def span(self) -> Number:
        """Length [m]."""
        return self.length

    @property
    def throat(self) -> Circle:
        """Cross-section of the ceramic."""
        return circle(self.diameter)

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the preload does not exceed the maximum load, and the bias is within the voltage range."""
        yield Order("preload", self.preload, self.maximum_load, "the maximum load", "Use a smaller preload", FORCE, strict=False)
        yield from super().orders
