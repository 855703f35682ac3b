"""Shear piezos as uniform blocks."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.force_actuator import point_masses
from flexstage.beams.law import PartLaw
from flexstage.beams.section import rectangle
from flexstage.parts.shear_piezo import ShearPiezo


def shear_piezo_compliance(part: ShearPiezo) -> Array:
    """Compliance (..., 6, 6) about its centre: 1/k_a along x, 1/k along y, along z as along y but for the bending, L/(E I) and L/(G J).

    G follows from what shear gives way, L / (kappa G A) with the parabolic kappa of `rectangle`; torsion after Saint-Venant.
    """
    section = rectangle(part.width, part.depth)
    about_y, about_z = part.bending
    shear = part.shear_compliance
    modulus = section.shear * part.length / (shear * section.area)
    across = shear + part.length**3 / (12.0 * about_y)
    turns = (part.length / (modulus * section.torsion), part.length / about_y, part.length / about_z)
    diagonal = np.stack(np.broadcast_arrays(1.0 / part.axial_stiffness, 1.0 / part.stiffness, across, *turns), axis=-1)
    return diagonal[..., None] * np.eye(6)


SHEAR_PIEZO = PartLaw(
    compliance=shear_piezo_compliance, mass=lambda part: point_masses(0.5 * part.mass, 0.5 * part.mass), needs_material=False
)
