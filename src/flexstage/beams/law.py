"""Part laws of beam theory by kind, and their register. The package `beams` fills the register; kinds without an entry have no law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number
from flexstage.beams.beam import Beam
from flexstage.beams.fixed_end_modes import FixedEndModes
from flexstage.parts.material import Material

_CALIBRATE = 'Specify a measured or computed 6x6 compliance matrix (kind = "compliance_matrix"), or expect a larger model error'


@dataclass(frozen=True, eq=False)
class Range:
    """Ratio of dimensions, such as t/R, with the interval in which beam theory was compared with finite elements."""

    name: str
    value: Array
    low: float = 0.0
    high: float = float("inf")

    def finding(self, where: str) -> Finding | None:
        """Return a warning if the ratio of a design is outside the interval (for a batch, the first such design), else `None`."""
        values = np.atleast_1d(self.value).ravel()
        outside = np.flatnonzero((values < self.low) | (values > self.high))
        if not outside.size:
            return None
        value = values[outside[0]]
        bound, side = (self.low, "below") if value < self.low else (self.high, "above")
        place = where if values.size == 1 else f"{where}[{outside[0]}]"
        return Finding(
            place, f"{self.name} = {value:.3g} is {side} {bound:g}, the limit of the comparison with finite elements", _CALIBRATE
        )


def ratio(top: Number, bottom: Number) -> Array:
    """Return the ratio of the real parts of two dimensions."""
    return np.real(np.asarray(top)) / np.real(np.asarray(bottom))


@dataclass(frozen=True)
class PartLaw:
    """Law of a kind of part: functions of a part, or of a part and its material. A `beam` has no material if not `needs_material`.

    Usually, `beam` defines compliance, mass, geometric stiffness and stress of the part. For plates, `diagonal` (..., 6) replaces the
    beam's compliance. All 6x6 matrices are about the centre. These entries describe a part without a beam:

    - `compliance` (..., 6, 6), or `stiffness` (..., 6, 6) if it may be singular or negative in some DOFs;
    - `material_stiffness` (..., 6, 6) instead of `stiffness` if the stiffness depends on the material;
    - `mass` (..., 12, 12).

    Optional entries:

    - `damping`: the viscous damping (..., 6, 6) [N s/m];
    - `twisting_load`: the compression [N] at which a column buckles in twist, for kinds of parts in which this load can be below Euler's
      load;
    - `concentration`: the stress concentration factor of the part's notches; if this factor is missing or `None`, the stress is unknown;
    - `ranges`: ratios of dimensions with the intervals that were compared with finite elements;
    - `family`: the name of the fitted function for the model error;
    - `fixed_end_modes`: the lowest fixed-end modes (number: `inner_modes`), at stations x divided by the half length (-1 to 1).
    """

    beam: Callable[[Any, Any], Beam] | None = None
    diagonal: Callable[[Any, Material], Array] | None = None
    compliance: Callable[[Any], Array] | None = None
    stiffness: Callable[[Any], Array] | None = None
    material_stiffness: Callable[[Any, Material], Array] | None = None
    mass: Callable[[Any], Array] | None = None
    damping: Callable[[Any], Array | None] | None = None
    twisting_load: Callable[[Any, Material], Number] | None = None
    concentration: Callable[[Any], Number | None] | None = None
    ranges: Callable[[Any], tuple[Range, ...]] = lambda _: ()
    family: Callable[[Any], str | None] = lambda _: None
    fixed_end_modes: Callable[[Any, Material, Array], tuple[FixedEndModes, ...]] | None = None
    needs_material: bool = True
