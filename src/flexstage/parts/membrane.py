"""Flat annular membranes (diaphragms) between a rigid hub and a rigid rim."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, MASS, NOT_NEGATIVE, POSITIVE
from flexstage.parts.freedom import Freedom
from flexstage.parts.shape import Elastic, Order


@dataclass(frozen=True, eq=False)
class Membrane(Elastic):
    """A flat ring of sheet, normal to x, clamped to a hub of `inner` diameter (second body) and in a rim of `outer` diameter (first body).

    Both are rigid, and both ends of the part lie in its centre. Intended freedoms: along x, and tilt about y and z. `mass` counts half at
    the hub and half at the rim. It has no shape for finite elements: a spiral, or a membrane with holes, is a `compliance_matrix` instead.
    """

    kind: ClassVar[str] = "membrane"
    material: str
    inner: Annotated[Number, LENGTH, POSITIVE]
    outer: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Along its normal, and both tilts."""
        return (Freedom.X, Freedom.RY, Freedom.RZ)

    @property
    def mirrored(self) -> Membrane:
        """Itself."""
        return self

    @property
    def orders(self) -> Iterator[Order]:
        """The hub is smaller than the rim."""
        yield Order("inner", self.inner, self.outer, "the outer diameter", "Exchange them")
