"""Flexure law of a part that bends, for large displacements. All other parts have only a 6x6 stiffness matrix about the centre."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from flexstage.beams.compliance import beam_of
from flexstage.beams.flexure.law import DEFAULT, STRESSES, FlexureLaw, Resolution, beam_law, leaf_law, natural_curvature
from flexstage.beams.reinforced_leaf import reinforced_plate
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Part
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.rod import Rod


def _of_leaf(part: Leaf, material: Material, resolution: Resolution) -> FlexureLaw:
    if part.section is LeafSection.BEAM:
        return beam_law(beam_of(part, material), resolution, flat=True, curvature=natural_curvature(part, material))
    return leaf_law(part, material, resolution, warps=part.warps)


def _of_rod(part: Rod, material: Material, resolution: Resolution) -> FlexureLaw:
    return beam_law(beam_of(part, material), resolution, curvature=0.0 if part.curvature is None else float(part.curvature))


def _of_hinge(part: Notch | Neck, material: Material, resolution: Resolution) -> FlexureLaw:
    """With more points than a leaf, because the curvature has a peak at the throat: an odd number, so that the throat is a point."""
    return beam_law(beam_of(part, material), replace(STRESSES, points=max(21, resolution.points)))


def _of_reinforced(part: ReinforcedLeaf, material: Material, resolution: Resolution) -> FlexureLaw:
    return beam_law(reinforced_plate(part, material), replace(STRESSES, points=resolution.points))


_KINDS: Mapping[type, Callable[[Any, Material, Resolution], FlexureLaw]] = {
    Leaf: _of_leaf,
    Rod: _of_rod,
    Notch: _of_hinge,
    Neck: _of_hinge,
    ReinforcedLeaf: _of_reinforced,
}


def flexure_law(part: Part, material: Material | None, resolution: Resolution = DEFAULT) -> FlexureLaw | None:
    """Return the flexure law of a part that bends, or `None` for a part that has only a 6x6 stiffness matrix.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> flexure_law(Rod("steel", length=0.1, diameter=0.002), steel).signature
    (10, 3, 20, 0)
    """
    part_law = _KINDS.get(type(part))
    return None if part_law is None or material is None else part_law(part, material, resolution)
