"""What each part and each outline of a body looks like: facets in its own frame."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.parts.body import Block, Cylinder, Imported, Solid
from flexstage.parts.leaf import Leaf
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Part, Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular, Elliptic, Filleted, Profile, length
from flexstage.parts.rod import Rod
from flexstage.show.scene.facet import Facet, Paint, circle, extruded, loft, pierced, rectangle

_ARC = np.deg2rad([0.0, 45.0, 90.0])
_ROUND_NECK_SIDES = 8


def plain(value: Number | None, default: float = 0.0) -> float:
    """The value of the first design as a float.

    >>> plain(np.array([2.0, 3.0])), plain(None)
    (2.0, 0.0)
    """
    return default if value is None else float(np.real(np.asarray(value).ravel()[0]))


def part_length(part: Part) -> float:
    """Length of a part along its x axis [m]; 0 where it has none (given matrices, joints).

    >>> part_length(Rod("steel", length=0.03, diameter=0.001))
    0.03
    """
    inner = part.part if isinstance(part, Restricted) else part
    if isinstance(inner, (Notch, Neck)):
        return plain(length(inner.profile))
    return plain(getattr(inner, "length", None))


def part_section(part: Part) -> tuple[float, float]:
    """Extents of a part's end section along its y and z axes [m]; 0 where it has none.

    >>> part_section(Rod("steel", length=0.03, diameter=0.001))
    (0.001, 0.001)
    """
    inner = part.part if isinstance(part, Restricted) else part
    if isinstance(inner, (Notch, Neck)):
        growth = 2.0 * float(silhouette(inner.profile)[1][0])
        height = plain(inner.thickness) + growth
        if isinstance(inner, Notch):
            return height, plain(inner.width)
        return height, height if inner.width is None else plain(inner.width) + growth
    if isinstance(inner, Leaf):
        return plain(inner.thickness), plain(inner.width)
    return plain(getattr(inner, "diameter", None)), plain(getattr(inner, "diameter", None))


def silhouette(profile: Profile) -> tuple[Array, Array]:
    """Stations x (s,) from end to end and the height w (s,) a profile adds on each side [m].

    >>> stations, heights = silhouette(Circular(0.005))
    >>> float(stations[0]), heights.round(6).tolist()
    (-0.005, [0.005, 0.001464, 0.0, 0.001464, 0.005])
    """
    half = 0.5 * plain(length(profile))
    if isinstance(profile, (Circular, Elliptic)):
        across = plain(profile.radius if isinstance(profile, Circular) else profile.across)
        stations, heights = half * np.sin(_ARC), across * (1.0 - np.cos(_ARC))
    elif isinstance(profile, Filleted):
        radius = plain(profile.radius)
        stations, heights = half - radius + radius * np.sin(_ARC), radius * (1.0 - np.cos(_ARC))
    else:
        stations, heights = np.array([half]), np.array([0.0])
    keep = stations > 0.0
    middle = ([0.0], [0.0]) if isinstance(profile, (Circular, Elliptic)) else ([], [])
    return (
        np.concatenate([-stations[keep][::-1], middle[0], stations[keep]]),
        np.concatenate([heights[keep][::-1], middle[1], heights[keep]]),
    )


def part_facets(part: Part, paint: Paint, marker: float) -> list[Facet]:
    """Facets of a part in its link frame; a part without a shape of its own is a cube of edge `marker` [m].

    >>> from flexstage.show.scene.facet import Kind
    >>> len(part_facets(Rod("steel", length=0.03, diameter=0.001), Paint(Kind.HINGE, ("a", "b")), 0.01))
    14
    """
    inner = part.part if isinstance(part, Restricted) else part
    ends = 0.5 * part_length(inner) * np.array([-1.0, 1.0])
    if isinstance(inner, (Notch, Neck)):
        return _hinge(inner, paint)
    if isinstance(inner, Leaf):
        return loft(extruded(ends, [rectangle(plain(inner.thickness), plain(inner.width))] * 2), paint)
    if isinstance(inner, (Rod, Piezo)):
        return loft(extruded(ends, [circle(plain(inner.diameter))] * 2), paint, round_section=True)
    return loft(extruded(0.5 * marker * np.array([-1.0, 1.0]), [rectangle(marker, marker)] * 2), paint)


def _hinge(part: Notch | Neck, paint: Paint) -> list[Facet]:
    stations, heights = silhouette(part.profile)
    thickness = plain(part.thickness) + 2.0 * heights
    if isinstance(part, Notch):
        return loft(extruded(stations, [rectangle(each, plain(part.width)) for each in thickness]), paint)
    if part.width is None:
        return loft(extruded(stations, [circle(each, _ROUND_NECK_SIDES) for each in thickness]), paint, round_section=True)
    width = plain(part.width) + 2.0 * heights
    return loft(extruded(stations, [rectangle(*each) for each in zip(thickness, width, strict=True)]), paint)


def solid_facets(solid: Solid, paint: Paint) -> list[Facet]:
    """Facets of an outline in its own frame: its centre at the origin, a cylinder's axis along x.

    >>> from flexstage.show.scene.facet import Kind
    >>> len(solid_facets(Block("steel", (0.1, 0.1, 0.01)), Paint(Kind.BODY, ("a", "a"))))
    6
    """
    if isinstance(solid, Imported):  # shown as the box around it
        return _block(Block(solid.material, solid.size), paint)
    return _block(solid, paint) if isinstance(solid, Block) else _cylinder(solid, paint)


def _block(solid: Block, paint: Paint) -> list[Facet]:
    size = [plain(value) for value in solid.size]
    outer = _prism(rectangle(size[0], size[1]), size[2])
    if solid.hole is None:
        return loft(outer, paint)
    return pierced(outer, _prism(rectangle(plain(solid.hole[0]), plain(solid.hole[1])), size[2]), paint)


def _prism(section: Array, height: float) -> Array:
    """Bottom and top ring of an upright prism."""
    return np.stack([np.column_stack([section, np.full(len(section), level)]) for level in (-0.5 * height, 0.5 * height)])


def _cylinder(solid: Cylinder, paint: Paint) -> list[Facet]:
    ends = 0.5 * plain(solid.length) * np.array([-1.0, 1.0])
    outer = extruded(ends, [circle(plain(solid.diameter), 24)] * 2)
    if solid.bore is None:
        return loft(outer, paint, round_section=True)
    inner = extruded(ends, [circle(plain(solid.bore), 24)] * 2)
    return pierced(outer, inner, paint, round_section=True)
