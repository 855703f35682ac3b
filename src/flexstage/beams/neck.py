"""Two-axis neck hinges by beam theory."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.beam import Beam, beam
from flexstage.beams.law import PartLaw, Range
from flexstage.beams.profiled import concentration, proportions
from flexstage.beams.quadrature import stations
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.profile import Circular, Straight
from flexstage.parts.section import Rectangle, circle, cowper_circle


def neck_beam(part: Neck, material: Material) -> Beam:
    """Build the Timoshenko beam of a neck: round (Cowper's shear factor), or rectangular (shear factor 6/5) with two profiles.

    >>> from flexstage.parts.profile import Circular
    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> toroid = neck_beam(Neck("steel", thickness=0.001, profile=Circular(0.005)), steel)
    >>> round(float(toroid.diagonal()[5]), 6)  # reference B4: 2.20183e-4 rad/(N mm)
    0.220183
    """
    if part.width is None:
        points = stations(part.profile, part.thickness)
        factor = np.asarray(cowper_circle(material.contraction))[..., None]
        return beam(points, circle(_grow(part.thickness, points.growth), factor), material)
    points = stations(part.profile, np.minimum(part.thickness, part.width))
    return beam(points, Rectangle(_grow(part.thickness, points.growth), _grow(part.width, points.growth)), material)


def _grow(size: Number, growth: Array) -> Array:
    return np.asarray(size)[..., None] + 2.0 * growth


def _ranges(part: Neck) -> tuple[Range, ...]:
    return proportions(part.profile, part.thickness, "toroid" if part.width is None else "notch")


def _family(part: Neck) -> str | None:
    if isinstance(part.profile, Straight):
        return "bar"
    return "toroid" if part.width is None and isinstance(part.profile, Circular) else None


NECK = PartLaw(
    neck_beam,
    concentration=lambda part: concentration(part.profile, np.maximum(part.throat.height, part.throat.width)),  # highest across the larger
    ranges=_ranges,
    family=_family,
)
