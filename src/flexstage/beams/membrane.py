"""Flat annular membranes: thin plates for motion out of their plane, discs for motion in their plane.

With a and b the radii of hub and rim, t the thickness, D = E t^3 / (12 (1 - nu^2)), kappa = (3 - nu) / (1 + nu) of plane stress, and e =
(b^2 - a^2) / (b^2 + a^2), the stiffnesses are:

    along x      16 pi D / (b^2 (1 - s^2 - 4 s^2 ln(s)^2 / (1 - s^2))), s = a / b    (Timoshenko & Woinowsky-Krieger, Plates, section 17)
    about y, z   4 pi D / (ln(b/a) - e)                                              (sum of r, r^3, 1/r and r ln r, clamped edges)
    along y, z   2 pi (1 + kappa) G t / (kappa ln(b/a) - e / kappa)                  (sum of ln z, z^2 and 1/z^2: Muskhelishvili)
    about x      4 pi G t a^2 b^2 / (b^2 - a^2)
"""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.law import PartLaw, Range, ratio
from flexstage.parts.material import Material
from flexstage.parts.membrane import Membrane
from flexstage.parts.stated import point_masses


def membrane_stiffness(part: Membrane, material: Material) -> Array:
    """Compute the stiffness (..., 6, 6) of the hub relative to the rim, about the membrane's centre.

    The stiffness is valid for small displacements: beyond about half the thickness along x, a membrane stretches and becomes stiffer. Plate
    shear is neglected.

    >>> sheet = Membrane("steel", inner=0.02, outer=0.06, thickness=2e-4)
    >>> membrane_stiffness(sheet, Material(young=200e9, poisson=0.3, density=7750.0)).diagonal().round(1).tolist()
    [28671.4, 156826447.6, 156826447.6, 21749.5, 6.2, 6.2]
    """
    a, b, t = (0.5 * np.asarray(part.inner), 0.5 * np.asarray(part.outer), np.asarray(part.thickness))
    poisson, shear = material.contraction, material.shear
    plate = material.modulus * t**3 / (12.0 * (1.0 - poisson**2))
    kappa, share, log = (3.0 - poisson) / (1.0 + poisson), (a / b) ** 2, np.log(b / a)
    edge = (1.0 - share) / (1.0 + share)
    along = 16.0 * np.pi * plate / (b**2 * (1.0 - share - 4.0 * share * log**2 / (1.0 - share)))
    tilt = 4.0 * np.pi * plate / (log - edge)
    across = 2.0 * np.pi * (1.0 + kappa) * shear * t / (kappa * log - edge / kappa)
    about = 4.0 * np.pi * shear * t * a**2 / (1.0 - share)
    return np.stack(np.broadcast_arrays(along, across, across, about, tilt, tilt), axis=-1)[..., None] * np.eye(6)


def _ranges(part: Membrane) -> tuple[Range, ...]:
    return (Range("thickness over the width of the ring", 2.0 * ratio(part.thickness, part.outer - part.inner), high=0.05),)


MEMBRANE = PartLaw(material_stiffness=membrane_stiffness, mass=lambda part: point_masses(0.5 * part.mass, 0.5 * part.mass), ranges=_ranges)
