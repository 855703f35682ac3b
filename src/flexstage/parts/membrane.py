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
    """Flat annular membrane normal to x, clamped to a hub of `inner` diameter (second body) and a rim of `outer` diameter (first body).

    Hub and rim are rigid; the part's ends, at which it joins the two bodies, are both at its centre. Ideal degrees of freedom: translation
    along x, tilt about y and z. Half of `mass` is at the hub, half at the rim. The solid model cannot represent this part. For a spiral or
    perforated membrane, use a `compliance_matrix`.
    """

    kind: ClassVar[str] = "membrane"
    material: str
    inner: Annotated[Number, LENGTH, POSITIVE]
    outer: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom: translation along the normal x, and both tilts."""
        return (Freedom.X, Freedom.RY, Freedom.RZ)

    @property
    def mirrored(self) -> Membrane:
        """The same membrane, because it is symmetric."""
        return self

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the hub is smaller than the rim."""
        yield Order("inner", self.inner, self.outer, "the outer diameter", "Exchange both values")
