"""Reinforced leaf springs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.parts.leaf import Leaf
from flexstage.parts.profile import single
from flexstage.parts.section import Rectangle, Section
from flexstage.parts.shape import Order

_ARC = np.linspace(0.0, 0.5 * np.pi, 9)


@dataclass(frozen=True, eq=False)
class ReinforcedLeaf(Leaf):
    """Leaf spring with a reinforced middle: thin over the `flexure_length` at each end, `reinforced_thickness` between them.

    The steps in thickness are square, or have a quarter-circle fillet of radius `fillet` at the foot. The fillet is within the flexure
    length. The ideal degrees of freedom are the same as for a leaf. No model uses `inner_modes`, `curvature` and
    `face_temperature_difference` of a reinforced leaf: they must be absent or zero.
    """

    kind: ClassVar[str] = "reinforced_leaf"
    flexure_length: Annotated[Number, LENGTH, POSITIVE] = field(kw_only=True)
    reinforced_thickness: Annotated[Number, LENGTH, POSITIVE] = field(kw_only=True)
    fillet: Annotated[Number, LENGTH, POSITIVE] | None = field(default=None, kw_only=True)

    @property
    def is_prismatic(self) -> bool:
        """False, because the thickness has steps."""
        return False

    @property
    def step(self) -> Number:
        """Height of the step on each side [m]."""
        return 0.5 * (self.reinforced_thickness - self.thickness)

    @property
    def silhouette(self) -> tuple[tuple[float, Section], ...]:
        """Stations x [m] of ends, steps and fillets, with the section at each station."""
        half, radius = 0.5 * single(self.length), 0.0 if self.fillet is None else single(self.fillet)
        start = half - single(self.flexure_length)
        arc = [(start + radius * (1.0 - np.sin(p)), radius * (1.0 - np.cos(p))) for p in (_ARC[::-1] if radius else _ARC[:1])]
        right = [(start, single(self.step)), *arc, (half, 0.0)]
        rows = [*((-x, up) for x, up in reversed(right)), *right]
        return tuple((float(x), Rectangle(self.thickness + 2.0 * up, self.width).first) for x, up in rows)

    @property
    def faults(self) -> Iterator[Finding]:
        """Errors: specified keys of a leaf that no model of a reinforced leaf uses."""
        for name in ("inner_modes", "curvature", "face_temperature_difference"):
            if np.any(getattr(self, name)):
                yield Finding(name, "not modelled in a reinforced leaf", "Remove it, or use a leaf")

    @property
    def orders(self) -> Iterator[Order]:
        """Required: flexures are at most as thick as the middle and fit into the length; fillets fit into steps and flexures."""
        yield from super().orders
        half, advice = 0.5 * self.length, "Make the leaf longer or the flexures shorter"
        yield Order("flexure_length", self.flexure_length, half, "half the length", advice)
        yield Order(
            "thickness", self.thickness, self.reinforced_thickness, "the reinforced_thickness", "Exchange both values", strict=False
        )
        if self.fillet is not None:
            yield Order("fillet", self.fillet, self.step, "the height of the step", "Make the fillet smaller", strict=False)
            yield Order("fillet", self.fillet, self.flexure_length, "the flexure_length", "Make the fillet smaller")
