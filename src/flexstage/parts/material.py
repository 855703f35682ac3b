"""Isotropic linear-elastic materials."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from flexstage.base.digest import DOCUMENT_ONLY, Description
from flexstage.base.number import Number
from flexstage.base.quantity import (
    DENSITY,
    EXPANSION,
    MODULUS,
    NOT_NEGATIVE,
    POISSON_RANGE,
    POSITIVE,
    PRESSURE,
    RATIO,
)


@dataclass(frozen=True, eq=False)
class Material(Description):
    """An isotropic linear-elastic material.

    `young` [Pa], `poisson` [-], `density` [kg/m^3]; optional: `yield_stress` [Pa], `expansion` [1/K], `loss_factor` [-].

    >>> Material(young=200e9, poisson=0.25, density=7750.0).shear
    80000000000.0
    """

    young: Annotated[Number, MODULUS, POSITIVE]
    poisson: Annotated[Number, RATIO, POISSON_RANGE]
    density: Annotated[Number, DENSITY, NOT_NEGATIVE]
    yield_stress: Annotated[Number, PRESSURE, POSITIVE] | None = None
    expansion: Annotated[Number, EXPANSION] | None = None
    loss_factor: Annotated[Number, RATIO, NOT_NEGATIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)

    @property
    def shear(self) -> Number:
        """Shear modulus G = E / (2 (1 + nu)) [Pa]."""
        return self.young / (2.0 * (1.0 + self.poisson))
