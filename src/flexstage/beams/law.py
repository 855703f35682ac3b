"""What beam theory knows of a kind of part, and the register of it. `beams` fills it; no entry means that nothing is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number
from flexstage.beams.beam import Beam
from flexstage.beams.held import Held
from flexstage.parts.material import Material

_CALIBRATE = 'State a measured or computed 6x6 (kind = "compliance_matrix"), or count on a larger error than the one stated'


@dataclass(frozen=True, eq=False)
class Range:
    """A ratio of dimensions, such as t/R, and the interval in which beam theory was compared with elasticity."""

    name: str
    value: Array
    low: float = 0.0
    high: float = float("inf")

    def finding(self, where: str) -> Finding | None:
        """Advice if a design lies outside, telling the first one; else `None`."""
        values = np.atleast_1d(self.value).ravel()
        outside = np.flatnonzero((values < self.low) | (values > self.high))
        if not outside.size:
            return None
        value = values[outside[0]]
        bound, side = (self.low, "below") if value < self.low else (self.high, "above")
        place = where if values.size == 1 else f"{where}[{outside[0]}]"
        return Finding(place, f"{self.name} = {value:.3g} is {side} {bound:g}, the limit of what beam theory was compared with", _CALIBRATE)


def ratio(top: Number, bottom: Number) -> Array:
    """The real ratio of two dimensions."""
    return np.real(np.asarray(top)) / np.real(np.asarray(bottom))


def _no_ranges(_: Any) -> tuple[Range, ...]:
    return ()


def _no_family(_: Any) -> str | None:
    return None


@dataclass(frozen=True)
class PartLaw:
    """The law of a kind: of a part and its material, or of a part alone where `needs_material` is false.

    A part is a `beam`, from which its compliance, mass, geometric stiffness and stress follow; `diagonal` is its compliance (..., 6) where
    that is not the beam's own (plates). A part without a beam states its whole `compliance` (..., 6, 6), or its `stiffness` (..., 6, 6)
    where that may be singular or negative in some freedoms (then its compliance need not exist; `material_stiffness` where it is that of a
    part and its material), and `mass` (..., 12, 12), all about its centre. `damping` is the viscous one (..., 6, 6) [N s/m] of a part that
    states it, about its centre too. `twisting_load` is the compression [N] at which a column of this kind twists, below Euler's
    load. `concentration` is the factor of its notches on the nominal stress; without it, or where it is `None`,
    its stress is unknown. `ranges` are those in which the law was compared with elasticity, `family` names the fitted laws that tell its
    error. `held` are the modes it has while its ends are held, as many as it asks for, at stations of its half length from -1 to 1.
    """

    beam: Callable[[Any, Any], Beam] | None = None
    diagonal: Callable[[Any, Material], Array] | None = None
    compliance: Callable[[Any], Array] | None = None
    stiffness: Callable[[Any], Array] | None = None
    material_stiffness: Callable[[Any, Material], Array] | None = None
    mass: Callable[[Any], Array] | None = None
    damping: Callable[[Any], Array] | None = None
    twisting_load: Callable[[Any, Material], Number] | None = None
    concentration: Callable[[Any], Number | None] | None = None
    ranges: Callable[[Any], tuple[Range, ...]] = _no_ranges
    family: Callable[[Any], str | None] = _no_family
    held: Callable[[Any, Material, Array], tuple[Held, ...]] | None = None
    needs_material: bool = True
