"""Round rods by beam theory."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.beam import Beam, beam
from flexstage.beams.fixed_end_modes import Bending, FixedEndModes, Torsion, fixed_end_bending, fixed_end_twist
from flexstage.beams.law import PartLaw, Range, ratio
from flexstage.beams.quadrature import stations
from flexstage.parts.material import Material
from flexstage.parts.profile import Straight
from flexstage.parts.rod import Rod
from flexstage.parts.section import circle, cowper_circle


def rod_beam(part: Rod, material: Material) -> Beam:
    """Build the Timoshenko beam of a rod: circular section with Cowper's shear factor.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> rod = rod_beam(Rod("steel", length=0.1, diameter=0.002), steel)
    >>> round(float(rod.diagonal()[0] * 200e9 * np.pi * 1e-6), 12)
    0.1
    """
    points = stations(Straight(part.length), part.diameter)
    factor = np.asarray(cowper_circle(material.contraction))[..., None]
    return beam(points, circle(np.asarray(part.diameter)[..., None] + points.growth, factor), material)


def rod_modes(part: Rod, material: Material, places: Array) -> tuple[FixedEndModes, ...]:
    """Compute the fixed-end modes of a rod: bending along y and z, and twist. `places` (s,) are values of x divided by the half length.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> [fixed_end_modes.axis for fixed_end_modes in rod_modes(Rod("steel", length=0.1, diameter=0.002, inner_modes=1), steel, np.zeros(1))]
    [1, 2, 3]
    """
    section, density = circle(part.diameter, cowper_circle(material.contraction)), material.density
    shear = material.shear * section.area / section.shear
    bending = Bending(part.length, material.modulus * section.inertia_z, shear, density * section.area, density * section.inertia_z)
    torsion = Torsion(part.length, material.shear * section.torsion, density * section.polar)
    across = (fixed_end_bending(axis, bending, part.inner_modes, places) for axis in (1, 2))
    return (*across, fixed_end_twist(torsion, part.inner_modes, places))


def _ranges(part: Rod) -> tuple[Range, ...]:
    return (Range("length over diameter", ratio(part.length, part.diameter), low=5.0),)


ROD = PartLaw(rod_beam, concentration=lambda _: 1.0, ranges=_ranges, family=lambda _: "bar", fixed_end_modes=rod_modes)
