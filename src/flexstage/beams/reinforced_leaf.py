"""Leaves with a thick middle by beam theory: three pieces in series, with plate action in the two thin ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.beam import Beam, flexibility, inertia, shear_across
from flexstage.beams.law import PartLaw, Range, ratio
from flexstage.beams.plate import moment_factor, shear_factor
from flexstage.beams.quadrature import Stations, in_series, stations
from flexstage.beams.torsion import constrained_twist, free_twist
from flexstage.parts.leaf import LeafSection
from flexstage.parts.material import Material
from flexstage.parts.profile import Circular, Straight
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.section import Rectangle, cowper_rectangle


def reinforced_beam(part: ReinforcedLeaf, material: Material) -> Beam:
    """Build the Timoshenko beam of varying thickness (Cowper's shear factor); warping is restrained unless its ends may warp.

    Warping and bimoment are continuous at the steps (Vlasov's beam with the shear of `beams.torsion`).
    """
    points = _points(part)
    thickness = np.asarray(part.thickness)[..., None] + 2.0 * points.growth
    section = Rectangle(thickness, np.asarray(part.width)[..., None], np.asarray(cowper_rectangle(material.contraction))[..., None])
    young, shear, density = (np.asarray(each)[..., None] for each in (material.modulus, material.shear, material.density))
    twisting = free_twist(section, shear) if part.warps else constrained_twist(section, points, young, shear)
    return Beam(points, section, flexibility(section, young, shear, twisting, shear_across(material)), inertia(section, density), twisting)


def reinforced_diagonal(part: ReinforcedLeaf, material: Material) -> Array:
    """Compute the diagonal (..., 6) of the compliance about the centre: the beam's compliance, reduced by plate action of the thin ends.

    Each thin end, up to its fillet, is treated as a leaf whose two ends cannot curve across the width. `beams.plate` gives different
    stiffness factors for the moment at the centre of the leaf and for the shear force. The thick middle is assumed to prevent curvature of
    the leaf across the width, which is valid if it is twice as thick as the ends. The thick middle bends as a beam. If `section` is "beam",
    plate action is neglected.
    """
    whole = reinforced_beam(part, material).diagonal()
    if part.section is LeafSection.BEAM:
        return whole
    thin = part.flexure_length - (0.0 if part.fillet is None else part.fillet)
    slenderness, arm = thin / part.width, 0.5 * (part.length - thin)
    turning = 24.0 * thin / (material.modulus * part.width * part.thickness**3)
    rotation = turning * (1.0 / moment_factor(slenderness, material.contraction) - 1.0)
    across = turning * thin * thin / 12.0 * (1.0 / shear_factor(slenderness, material.contraction) - 1.0)
    nothing = np.zeros(np.broadcast_shapes(np.shape(rotation), np.shape(arm)))
    return whole + np.stack(np.broadcast_arrays(nothing, arm * arm * rotation + across, nothing, nothing, nothing, rotation), axis=-1)


def reinforced_plate(part: ReinforcedLeaf, material: Material) -> Beam:
    """Build the beam whose bending equals `reinforced_diagonal`: plate action reduces the flexibility of the thin ends about z.

    Over each thin end (u = -1 to 1), the flexibility of the beam is multiplied by a + c u^2. The constants a and c reproduce the plate's
    rotation under a moment and its deflection under a shear force.
    """
    whole = reinforced_beam(part, material)
    if part.section is LeafSection.BEAM:
        return whole
    thin = part.flexure_length - (0.0 if part.fillet is None else part.fillet)
    slenderness = thin / part.width
    mean, second = (1.0 / each(slenderness, material.contraction) for each in (moment_factor, shear_factor))
    slope = 3.75 * (second - mean)
    place = (whole.points.position - 0.5 * (part.length - thin)) / (0.5 * thin)
    share = np.where(np.real(place) >= -1.0, mean + slope * (place * place - 1.0 / 3.0), 1.0)
    flexible = np.array(whole.flexibility)
    flexible[..., 5] = flexible[..., 5] * share
    return replace(whole, flexibility=flexible)


def _points(part: ReinforcedLeaf) -> Stations:
    """Rules of the middle, of the fillet if any, and of the thin end."""
    start = 0.5 * part.length - part.flexure_length
    radius: Number = 0.0 if part.fillet is None else part.fillet
    middle, thin = (stations(Straight(2.0 * each), part.thickness) for each in (start, part.flexure_length - radius))
    middle = Stations(middle.position, middle.rate, np.asarray(part.step)[..., None] + middle.growth, middle.rule)
    if part.fillet is None:
        return in_series([middle, thin], [0.0, start])
    return in_series([middle, _descend(stations(Circular(radius), part.thickness), radius), thin], [0.0, start, start + radius])


def _descend(arc: Stations, radius: Number) -> Stations:
    """A quarter circle from its end to its throat."""
    position = np.asarray(radius)[..., None] - arc.position
    return Stations(position[..., ::-1], arc.rate[..., ::-1], arc.growth[..., ::-1], arc.rule)


def _concentration(part: ReinforcedLeaf) -> Number:
    """Smith's factor of the fillet (`beams.profiled.concentration`); corners without a fillet are not described, as for a leaf."""
    return 1.0 if part.fillet is None else (1.0 + part.thickness / (2.0 * part.fillet)) ** 0.45


def _ranges(part: ReinforcedLeaf) -> tuple[Range, ...]:
    thin = Range("thickness over width", ratio(part.thickness, part.width), high=0.2)
    long = Range("flexure length over thickness", ratio(part.flexure_length, part.thickness), low=10.0)
    return thin, long, Range("reinforced thickness over thickness", ratio(part.reinforced_thickness, part.thickness), low=2.0)


REINFORCED_LEAF = PartLaw(reinforced_beam, reinforced_diagonal, concentration=_concentration, ranges=_ranges)
