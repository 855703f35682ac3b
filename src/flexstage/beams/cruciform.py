"""Cruciform torsion hinges by beam theory, with restrained warping at the ends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexstage.base.number import Number
from flexstage.beams.beam import Beam, flexibility, inertia, shear_across
from flexstage.beams.law import PartLaw, Range, ratio
from flexstage.beams.quadrature import stations
from flexstage.beams.torsion import Twisting, constrained_twist
from flexstage.parts.cruciform import Cruciform, cross
from flexstage.parts.material import Material
from flexstage.parts.profile import Straight
from flexstage.parts.section import Rectangle


@dataclass(frozen=True, eq=False)
class _HalfCross(Rectangle):
    """One of the two leaves, with half of the torsion constant of the `whole` hinge."""

    whole: Number = 0.0

    @cached_property
    def torsion(self) -> Number:
        """Half of the torsion constant of the whole hinge [m^4]."""
        return 0.5 * self.whole


def cruciform_beam(part: Cruciform, material: Material) -> Beam:
    """Build the Timoshenko beam of a cruciform hinge. Both leaves carry equal torque, with restrained warping as in `beams.torsion`.

    For thin leaves, the torsional stiffness K approaches the result of Vlasov (Thin-Walled Elastic Beams, 1961):

    K = G J / (L (1 - tanh(k L / 2) / (k L / 2))), k^2 = G J / (E C_w), with the length L, the torsion constant J and the warping constant
    C_w. The restrained contraction at the rigid ends is neglected.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> hinge = Cruciform("steel", length=0.03, thickness=0.001, width=0.01)
    >>> round(float(1.0 / cruciform_beam(hinge, steel).diagonal()[3]), 2), round(float(hinge.throat.torsion) * steel.shear / 0.03, 2)
    (19.84, 16.88)
    """
    points = stations(Straight(part.length), part.thickness)
    section = cross(np.asarray(part.thickness)[..., None] + points.growth, np.asarray(part.width)[..., None])
    young, shear, density = (np.asarray(each)[..., None] for each in (material.modulus, material.shear, material.density))
    leaf = constrained_twist(_HalfCross(section.thickness, section.width, whole=section.torsion), points, young, shear)
    twisting = Twisting(0.5 * leaf.rate, leaf.bimoment)
    return Beam(points, section, flexibility(section, young, shear, twisting, shear_across(material)), inertia(section, density), twisting)


def torsional_buckling(part: Cruciform, material: Material) -> Number:
    """Compute the torsional buckling load G J A / I_p [N], for any length (Timoshenko & Gere, Theory of Elastic Stability, 5.4).

    I_p is the polar second moment and A the area of the section, J its torsion constant. Restrained warping at the ends raises the load;
    this increase is neglected.
    """
    section = part.throat
    return material.shear * section.torsion * section.area / section.polar


def _ranges(part: Cruciform) -> tuple[Range, ...]:
    thin = Range("thickness over width", ratio(part.thickness, part.width), high=0.25)
    return thin, Range("length over width", ratio(part.length, part.width), low=2.0)


CRUCIFORM = PartLaw(cruciform_beam, concentration=lambda _: 1.0, ranges=_ranges, twisting_load=torsional_buckling)
