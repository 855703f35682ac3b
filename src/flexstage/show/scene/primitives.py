"""Surfaces ("skins") of parts and of bodies' outlines, each in its own frame."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from flexstage.base.number import Array, Number, first_design
from flexstage.parts.body import Block, Cylinder, Extrusion, Imported, Solid, SolidWithHoles, Sphere, triangles
from flexstage.parts.part import Part, inner
from flexstage.parts.profile import single
from flexstage.parts.section import Rectangle
from flexstage.parts.shape import Profiled, Shaped
from flexstage.show.scene.skin import ROUND, DrawnSurface, circle, extrude, face, join, loft, pierce, rectangle
from flexstage.spatial.frame import Frame

_ROUND_SIDES, _ROUND_NECK_SIDES = 12, 8


def first_value(value: Number | None) -> float:
    """Return the value of the first design of a batch as a float, or 0 for `None`.

    >>> first_value(np.array([2.0, 3.0])), first_value(None)
    (2.0, 0.0)
    """
    return 0.0 if value is None else single(value)


def part_length(part: Part) -> float:
    """Return the length of a part along its x axis [m], or 0 for parts without a shape (compliance matrices, joints).

    >>> from flexstage.parts.rod import Rod
    >>> part_length(Rod("steel", length=0.03, diameter=0.001))
    0.03
    """
    own = inner(part)
    return first_value(own.span) if isinstance(own, Shaped) else 0.0


def part_section(part: Part) -> tuple[float, float]:
    """Return the extents of a part's end section along its y and z axes [m], or 0 for parts without a shape.

    >>> from flexstage.parts.rod import Rod
    >>> part_section(Rod("steel", length=0.03, diameter=0.001))
    (0.001, 0.001)
    """
    own = inner(part)
    if not isinstance(own, Shaped):
        return 0.0, 0.0
    end = own.silhouette[0][1]
    return first_value(end.height), first_value(end.width)


def part_skin(part: Part, marker: float, *, steps: int = 1) -> DrawnSurface:
    """Build the surface of a part in its link frame; a part without a shape is drawn as a cube of edge `marker` [m].

    The surface is divided into rings along the part. The distance between rings is at most the part's length divided by `steps`.

    >>> from flexstage.parts.rod import Rod
    >>> len(part_skin(Rod("steel", length=0.03, diameter=0.001), 0.01).triangles)
    44
    """
    own = inner(part)
    if not isinstance(own, Shaped):
        ends = 0.5 * marker * np.array([-1.0, 1.0])
        silhouette, is_smooth = [(end, Rectangle(marker, marker)) for end in ends], False
    else:
        silhouette, is_smooth = own.silhouette, own.is_axisymmetric
    sides = _ROUND_NECK_SIDES if isinstance(own, Profiled) else _ROUND_SIDES
    angles = 2.0 * np.pi * (np.arange(sides) + 0.5) / sides
    stations = np.array([station for station, _ in silhouette])
    rings = extrude(stations, [section.outline(angles) for _, section in silhouette])
    rings, shares = _more_rings(rings, (stations - stations[0]) / (stations[-1] - stations[0]), steps)
    ends = [
        face(np.column_stack([np.full(len(piece), station), piece])[::turn], share)
        for (station, section), turn, share in ((silhouette[0], -1, 0.0), (silhouette[-1], 1, 1.0))
        for piece in section.pieces(angles)
    ]
    return join([loft(rings, along=ROUND if is_smooth else slice(None), closed=False, shares=shares), *ends])


def _more_rings(rings: Array, shares: Array, steps: int) -> tuple[Array, Array]:
    """Rings (s, k, 3) at their shares (s,), with further rings at distances of at most 1 / steps; and all shares."""
    counts = np.maximum(1, np.ceil(np.diff(shares) * steps - 1e-9)).astype(int)
    places = np.concatenate([number + np.arange(count) / count for number, count in enumerate(counts)] + [[len(counts)]])
    first = np.minimum(places.astype(int), len(counts) - 1)
    weight = (places - first)[:, None, None]
    return (1.0 - weight) * rings[first] + weight * rings[first + 1], np.interp(places, np.arange(len(shares)), shares)


def simplification(solid: Solid) -> str:
    """Describe the simplification with which an outline is drawn. Returns an empty string for an outline that is drawn exactly.

    >>> simplification(Block("steel", (0.1, 0.1, 0.01)))
    ''
    """
    return "without holes" if isinstance(solid, SolidWithHoles) else "as its bounding box" if isinstance(solid, Imported) else ""


def solid_skin(solid: Solid) -> DrawnSurface:
    """Build the surface of an outline in its own frame: centre at the origin, axis of a cylinder along x. Holes are drawn as edges.

    >>> len(solid_skin(Block("steel", (0.1, 0.1, 0.01))).triangles)
    12
    """
    if isinstance(solid, SolidWithHoles):
        holes = [solid_skin(hole).placed(first_frame(hole.frame)) for hole in solid.holes]
        return join([solid_skin(solid.solid), *(replace(each, triangles=each.triangles[:0]) for each in holes)])
    if isinstance(solid, Imported):  # shown as the box around it
        return solid_skin(Block(solid.material, solid.size))
    return _SOLIDS[type(solid)](solid)


def first_frame(frame: Frame) -> Frame:
    """Return the frame of the first design of a batch.

    >>> from flexstage.spatial.frame import identity
    >>> first_frame(identity()).position.tolist()
    [0.0, 0.0, 0.0]
    """
    return Frame(first_design(np.real(frame.rotation), 2), first_design(np.real(frame.position), 1))


def _block(solid: Block) -> DrawnSurface:
    size = [first_value(value) for value in solid.size]
    outer = _prism(rectangle(size[0], size[1]), size[2])
    if solid.hole is None:
        return loft(outer)
    return pierce(outer, _prism(rectangle(first_value(solid.hole[0]), first_value(solid.hole[1])), size[2]))


def _prism(section: Array, height: float) -> Array:
    """Bottom and top ring of an upright prism."""
    return np.stack([np.column_stack([section, np.full(len(section), level)]) for level in (-0.5 * height, 0.5 * height)])


def _cylinder(solid: Cylinder) -> DrawnSurface:
    ends = 0.5 * first_value(solid.length) * np.array([-1.0, 1.0])
    outer = extrude(ends, [circle(first_value(solid.diameter), 24)] * 2)
    if solid.bore is None:
        return loft(outer, along=ROUND)
    return pierce(outer, extrude(ends, [circle(first_value(solid.bore), 24)] * 2), along=ROUND)


def _extrusion(solid: Extrusion) -> DrawnSurface:
    corners = first_design(np.real(solid.corners), 2)
    sides, trios = loft(_prism(corners, first_value(solid.height)), closed=False), np.array(triangles(corners))
    return replace(sides, triangles=np.concatenate([sides.triangles, trios + len(corners), trios[:, ::-1]]))


def _sphere(solid: Sphere) -> DrawnSurface:
    radius = 0.5 * first_value(solid.diameter)
    angles = np.linspace(0.0, np.pi, 13)[1:-1]
    rings = extrude(-radius * np.cos(angles), [circle(2.0 * radius * float(np.sin(angle)), 24) for angle in angles])
    return loft(rings, ringed=(), along=ROUND)


_SOLIDS: Mapping[type[Solid], Callable[[Any], DrawnSurface]] = {
    Block: _block,
    Cylinder: _cylinder,
    Extrusion: _extrusion,
    Sphere: _sphere,
}
