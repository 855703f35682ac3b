"""Leaf springs by beam theory, with plate action and restrained warping, or without both if the `section` is a beam."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.beam import Beam, flexibility, inertia, shear_across
from flexstage.beams.fixed_end_modes import Bending, FixedEndModes, Plate, Torsion, fixed_end_bending, fixed_end_twist
from flexstage.beams.law import PartLaw, Range, ratio
from flexstage.beams.plate import moment_factor, shear_factor
from flexstage.beams.quadrature import Stations, stations
from flexstage.beams.torsion import Twisting, decays, free_twist
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.profile import Straight
from flexstage.parts.section import Rectangle, Section, cowper_rectangle


def leaf_beam(part: Leaf, material: Material) -> Beam:
    """Build the Timoshenko beam of a leaf without plate action (Cowper's shear factor); warping is restrained unless its ends may warp.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> leaf = leaf_beam(Leaf("steel", length=0.05, thickness=0.0005, width=0.01), steel)
    >>> round(float(leaf.diagonal()[5]), 6), round(0.05 / (200e9 * 0.01 * 0.0005**3 / 12.0), 6)
    (2.4, 2.4)
    """
    points = stations(Straight(part.length), part.thickness)
    thickness, width = np.asarray(part.thickness)[..., None] + points.growth, np.asarray(part.width)[..., None]
    section = Rectangle(thickness, width, np.asarray(cowper_rectangle(material.contraction))[..., None])
    young, shear = np.asarray(material.modulus)[..., None], np.asarray(material.shear)[..., None]
    twisting = free_twist(section, shear) if part.warps else _twisting(part, points, section, material)
    density = np.asarray(material.density)[..., None]
    return Beam(points, section, flexibility(section, young, shear, twisting, shear_across(material)), inertia(section, density), twisting)


def leaf_diagonal(part: Leaf, material: Material) -> Array:
    """Compute the diagonal (..., 6) of the leaf's compliance about its centre.

    The leaf is a Timoshenko beam with two changes: the bending compliance about z is divided by the plate factors of `beams.plate`, and the
    torsional compliance is that of `torsional_compliance`. In-plane bending and tension have the compliance of the beam. Restrained
    contraction is neglected: if the width is much larger than the length, the true compliance is smaller, by a factor down to 1 - nu^2.

    If `section` is "beam", all six entries are those of `leaf_beam`, a textbook frame element.

    >>> soft = Material(young=1.0, poisson=0.3, density=1.0)
    >>> wide = leaf_diagonal(Leaf("soft", length=1.0, thickness=1e-3, width=0.5), soft)
    >>> round(float(1.0 / (wide[5] * 0.5e-9 / 12.0)), 3)  # reference B6: 1.0377 at b/L = 0.5
    1.037
    """
    if part.section is LeafSection.BEAM:
        return leaf_beam(part, material).diagonal()
    slenderness, area = part.length / part.width, part.thickness * part.width
    inertia_y, inertia_z = area * part.width * part.width / 12.0, area * part.thickness * part.thickness / 12.0
    lateral = cowper_rectangle(material.contraction) * part.length / (material.shear * area)
    across = lateral if material.shear_across is None else lateral * (material.shear / material.shear_across)
    cubed = part.length * part.length * part.length / (12.0 * material.modulus)
    rows = np.broadcast_arrays(
        part.length / (material.modulus * area),
        cubed / (inertia_z * shear_factor(slenderness, material.contraction)) + across,
        cubed / inertia_y + lateral,
        torsional_compliance(part, material),
        part.length / (material.modulus * inertia_y),
        part.length / (material.modulus * inertia_z * moment_factor(slenderness, material.contraction)),
    )
    return np.stack(rows, axis=-1)


def torsional_compliance(part: Leaf, material: Material) -> Number:
    """Compute the torsional compliance of a leaf with restrained warping [rad/(N m)].

    The compliance is (L / (G J)) (1 - tanh(lam) / lam) with lam = (L/b) sqrt(6 / (1 + nu)), length L and width b.

    J is the torsion constant of the rectangle. If the ends may warp, the compliance is L / (G J). Compared with plate elements (reference
    B6), the compliance is too large by 0.2 % at b/L = 0.1, 1.2 % at 0.5 and 6 % at 2.

    >>> soft = Material(young=2.6, poisson=0.3, density=1.0)
    >>> thin = Leaf("soft", length=1.0, thickness=1e-5, width=0.5)
    >>> round(float(1.0 / torsional_compliance(thin, soft) / (0.5e-15 / 3.0)), 4)  # reference B6, closed form
    1.3032
    """
    torsion = Rectangle(part.thickness, part.width).torsion
    free = part.length / (material.shear * torsion)
    if part.warps:
        return free
    lam = 0.5 * _wavenumber(part, material) * part.length
    return free * (1.0 - np.tanh(lam) / lam)


def _wavenumber(part: Leaf, material: Material) -> Number:
    return np.sqrt(24.0 / material.twist_ratio) / part.width


def _twisting(part: Leaf, points: Stations, section: Section, material: Material) -> Twisting:
    """Twist rate (1 - cosh(kx) / cosh(kL/2)) / (G J) and its bimoment E C_w phi''."""
    wavenumber = np.asarray(_wavenumber(part, material))[..., None]
    free = 1.0 / (np.asarray(material.shear)[..., None] * section.torsion)
    straight, sloping = decays(points, wavenumber)
    warping = np.asarray(material.modulus)[..., None] * section.warping
    return Twisting(free * (1.0 - straight), -free * warping * wavenumber * sloping)


def leaf_modes(part: Leaf, material: Material, places: Array) -> tuple[FixedEndModes, ...]:
    """Compute the fixed-end modes of a leaf: bending along y, and twist. `places` (s,) are values of x divided by the half length.

    The leaf is a plate with restrained warping, unless its `section` and `ends` specify otherwise.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> bending, _ = leaf_modes(Leaf("steel", length=0.1, thickness=0.0002, width=0.01, inner_modes=1), steel, np.zeros(1))
    >>> round(float(bending.squares[0] ** 0.5 / (22.3733 * (200e9 * 0.0002**2 / 12.0 / 7750.0 / 0.1**4) ** 0.5)), 4)  # over a beam's
    1.0129
    """
    section = Rectangle(part.thickness, part.width, cowper_rectangle(material.contraction))
    density, is_plate = material.density, part.section is LeafSection.PLATE
    across = material.shear if material.shear_across is None else material.shear_across
    rigidity, shear = material.modulus * section.inertia_z, across * section.area / section.shear
    plate = Plate(part.width, material.contraction) if is_plate else None
    bending = Bending(part.length, rigidity, shear, density * section.area, density * section.inertia_z, plate)
    warped = section.area * section.area * section.area / 144.0
    warping = material.modulus * warped / (1.0 - material.contraction * material.contraction) if not part.warps else None
    torsion = Torsion(part.length, material.shear * section.torsion, density * section.polar, warping, density * warped, plate)
    return fixed_end_bending(1, bending, part.inner_modes, places), fixed_end_twist(torsion, part.inner_modes, places)


def _ranges(part: Leaf) -> tuple[Range, ...]:
    thin = Range("thickness over width", ratio(part.thickness, part.width), high=0.2)
    return thin, Range("length over thickness", ratio(part.length, part.thickness), low=10.0)


def _family(part: Leaf) -> str | None:
    return None if part.section is LeafSection.BEAM else "leaf"


LEAF = PartLaw(leaf_beam, leaf_diagonal, concentration=lambda _: 1.0, ranges=_ranges, family=_family, fixed_end_modes=leaf_modes)
