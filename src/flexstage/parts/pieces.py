"""Convex decomposition of solids: polytopes inside the material.

Flat faces are exact. Polygons inside the round faces deviate by at most `SAGITTA`: pieces touch only if the solids touch.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from flexstage.base.number import Array, first_design
from flexstage.parts.body import Block, Cylinder, Extrusion, Imported, Solid, SolidWithHoles, Sphere, triangles
from flexstage.parts.profile import single
from flexstage.spatial.convex import Convex, cuboid, frustum

SAGITTA = 2e-5
"""Largest distance [m] between a round face and the faces of the pieces inside it."""
MOST = 96
"""Largest number of sides of the polygon for a round outline."""


def solid_pieces(form: Solid) -> tuple[Convex, ...]:
    """Return the convex pieces of a solid in its frame, for the first design; none for an imported solid.

    Holes cut by other solids are ignored.

    >>> len(solid_pieces(Block("steel", (0.1, 0.1, 0.1)))), len(solid_pieces(Block("steel", (0.1, 0.1, 0.1), hole=(0.05, 0.05))))
    (1, 4)
    """
    return tuple(_SOLIDS[type(form)](form))


def _frame(form: Block) -> Iterator[Convex]:
    """A block, or four walls around its hole."""
    x, y, z = (0.5 * single(value) for value in form.size)
    if form.hole is None:
        yield cuboid((-x, -y, -z), (x, y, z))
        return
    inner, clear = (0.5 * single(value) for value in form.hole)
    for side in (-1.0, 1.0):
        low, high = sorted((side * inner, side * x))
        yield cuboid((low, -y, -z), (high, y, z))
        low, high = sorted((side * clear, side * y))
        yield cuboid((-inner, low, -z), (inner, high, z))


def _wedges(form: Extrusion) -> Iterator[Convex]:
    corners, half = first_design(np.real(form.corners), 2), 0.5 * single(form.height)
    for trio in triangles(corners):
        upright = frustum(-half, half, corners[list(trio)], corners[list(trio)])
        yield Convex(*(np.roll(each, -1, axis=1) for each in (upright.points, upright.normals, upright.edges)))


def _ball(form: Sphere) -> Iterator[Convex]:
    """Slabs between rings, from pole to pole."""
    radius = 0.5 * single(form.diameter)
    count = corner_count(radius) // 4 * 2
    angles = np.linspace(0.0, np.pi, count // 2 + 1)
    rims = [_circle(radius * np.sin(angle), count) for angle in angles]
    for here, there in pairwise(range(len(angles))):
        yield frustum(-radius * np.cos(angles[here]), -radius * np.cos(angles[there]), rims[here], rims[there])


def corner_count(radius: float) -> int:
    """Return the number of sides of an inscribed polygon within `SAGITTA` of a circle of `radius` [m].

    >>> corner_count(0.01)
    52
    """
    half = np.arccos(max(0.0, 1.0 - SAGITTA / radius))
    return int(np.clip(4 * np.ceil(np.pi / half / 4.0), 8, MOST))


def _circle(radius: float, count: int) -> Array:
    angles = 2.0 * np.pi * np.arange(count) / count
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def _tube(size: float, diameter: float, bore: float) -> Iterator[Convex]:
    half, count = 0.5 * size, corner_count(0.5 * diameter)
    rim = _circle(0.5 * diameter, count)
    if bore == 0.0:
        yield frustum(-half, half, rim, rim)
        return
    grown = 0.5 * bore / np.cos(np.pi / count)
    inner = _circle(min(grown, 0.5 * (grown + 0.5 * diameter)), count)
    for here, there in pairwise([*range(count), 0]):
        sector = np.array([rim[here], rim[there], inner[there], inner[here]])
        yield frustum(-half, half, sector, sector)


_SOLIDS: Mapping[type[Solid], Callable[[Any], Iterable[Convex]]] = {
    Block: _frame,
    Cylinder: lambda form: _tube(single(form.length), single(form.diameter), 0.0 if form.bore is None else single(form.bore)),
    Extrusion: _wedges,
    Sphere: _ball,
    Imported: lambda _: (),
    SolidWithHoles: lambda form: solid_pieces(form.solid),
}
