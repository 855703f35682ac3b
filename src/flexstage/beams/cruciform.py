"""Cruciform torsion hinges by beam theory: Vlasov's torsion with ends that cannot warp."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Number
from flexstage.beams.beam import Beam, flexibility, inertia, shear_across
from flexstage.beams.law import PartLaw, Range, ratio
from flexstage.beams.quadrature import stations
from flexstage.beams.torsion import Twisting, decays
from flexstage.parts.cruciform import Cruciform, cross
from flexstage.parts.material import Material
from flexstage.parts.profile import Straight


def cruciform_beam(part: Cruciform, material: Material) -> Beam:
    """The hinge as a Timoshenko beam with the twist rate of Vlasov between ends that cannot warp.

    phi' = T / (G J) (1 - cosh(k x) / cosh(k L / 2)), k^2 = G J / (E C_w) (Vlasov, Thin-Walled Elastic Beams, 1961): the hinge is stiffer
    than G J / L by 1 / (1 - tanh(k L / 2) / (k L / 2)). Not counted: contraction that rigid ends prevent, and that leaves stay plane.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> hinge = cruciform_beam(Cruciform("steel", length=0.03, thickness=0.001, width=0.01), steel)
    >>> round(float(1.0 / hinge.diagonal()[3]), 2), round(float(hinge.section.torsion) * steel.shear / 0.03, 2)
    (19.98, 16.88)
    """
    points = stations(Straight(part.length), part.thickness)
    section = cross(np.asarray(part.thickness)[..., None] + points.growth, np.asarray(part.width)[..., None])
    young, shear, density = (np.asarray(each)[..., None] for each in (material.modulus, material.shear, material.density))
    rigidity, warping = shear * section.torsion, young * section.warping
    wavenumber = np.sqrt(rigidity / warping)
    straight, sloping = decays(points, wavenumber)
    twisting = Twisting((1.0 - straight) / rigidity, -warping * wavenumber * sloping / rigidity)
    return Beam(points, section, flexibility(section, young, shear, twisting, shear_across(material)), inertia(section, density), twisting)


def torsional_buckling(part: Cruciform, material: Material) -> Number:
    """Compression at which its leaves twist, G J A / I_p [N], whatever its length (Timoshenko & Gere, Theory of Elastic Stability, 5.4).

    Warping restrained at the ends makes it larger, and is not counted.
    """
    section = part.throat
    return material.shear * section.torsion * section.area / section.polar


def _ranges(part: Cruciform) -> tuple[Range, ...]:
    thin = Range("thickness over width", ratio(part.thickness, part.width), high=0.25)
    return thin, Range("length over width", ratio(part.length, part.width), low=1.0)


CRUCIFORM = PartLaw(cruciform_beam, concentration=lambda _: 1.0, ranges=_ranges, twisting_load=torsional_buckling)
