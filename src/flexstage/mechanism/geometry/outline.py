"""Outlines of the solids of bodies and of the parts of links: boxes and cylinders in the stage's frame."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, stack
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink
from flexstage.parts.body import Block, Cylinder, Extrusion, PlacedSolid, SolidWithHoles, Sphere
from flexstage.parts.part import inner
from flexstage.parts.shape import Shaped
from flexstage.spatial.frame import Frame


@dataclass(frozen=True, eq=False)
class Outline:
    """Outline: a box of `size` (..., 3) [m] along the axes of `frame`, or a cylinder along x (`is_cylinder`) in this box.

    `name` is the address (`platform.plate`, `B1/front`). `hole` (..., 2) gives the sides of a rectangular hole through a box along z.
    `bore` is the diameter of a hole through a cylinder along x. `corners` (..., n, 3) are the corners of an outline that does not fill its
    box. If `is_ball`, the outline is a ball.
    """

    name: str
    frame: Frame
    size: Array
    is_cylinder: bool = False
    hole: Array | None = None
    bore: Array | None = None
    corners: Array | None = None
    is_ball: bool = False

    @property
    def designs(self) -> tuple[int, ...]:
        """Shape of the batch of positions and sizes."""
        corners = () if self.corners is None else self.corners.shape[:-2]
        return np.broadcast_shapes(self.frame.position.shape[:-1], self.frame.rotation.shape[:-2], self.size.shape[:-1], corners)

    def reach(self, direction: Array) -> Array:
        """Return the support function [m]: the maximum of n . r for all points r of the outline; n (..., 3) is a unit `direction`.

        >>> box = Outline("box", Frame(np.eye(3), np.zeros(3)), np.array([2.0, 4.0, 6.0]))
        >>> float(box.reach(np.array([0.0, 1.0, 0.0])))
        2.0
        """
        middle = np.sum(self.frame.position * direction, axis=-1)
        if self.is_ball:
            return middle + 0.5 * self.size[..., 0]
        if self.corners is not None:
            across = (self.frame.rotation.mT @ direction[..., None])[..., 0]
            return middle + np.max(np.sum(self.corners * across[..., None, :], axis=-1), axis=-1)
        own = np.abs((self.frame.rotation.mT @ direction[..., None])[..., 0])
        if not self.is_cylinder:
            return middle + 0.5 * np.sum(self.size * own, axis=-1)
        across = np.sqrt(np.maximum(0.0, 1.0 - own[..., 0] ** 2))
        return middle + 0.5 * (self.size[..., 0] * own[..., 0] + self.size[..., 1] * across)


def outlines(assembly: Assembly) -> tuple[Outline, ...]:
    """Return outlines of all solids (including the ground's), and of all parts that have dimensions.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> [outline.name for outline in outlines(expand(double_triangle()))][:2]
    ['platform.plate', 'platform.left']
    """
    placed = {name: solid for body in assembly.bodies.values() for name, solid in body.solids.items()} | dict(assembly.ground)
    solids = (_solid(name, solid) for name, solid in placed.items())
    return (*solids, *(outline for link in assembly.links.values() for outline in _part(link)))


def _solid(name: str, placed: PlacedSolid) -> Outline:
    solid = placed.solid.solid if isinstance(placed.solid, SolidWithHoles) else placed.solid
    if isinstance(solid, Cylinder):
        return Outline(name, placed.frame, solid.sides, is_cylinder=True, bore=None if solid.bore is None else np.asarray(solid.bore))
    if isinstance(solid, Extrusion):
        return Outline(name, placed.frame, solid.sides, corners=_prism(solid.corners, np.asarray(solid.height)))
    hole = None if not isinstance(solid, Block) or solid.hole is None else stack(solid.hole)
    return Outline(name, placed.frame, solid.sides, hole=hole, is_ball=isinstance(solid, Sphere))


def _part(link: PlacedLink) -> Iterator[Outline]:
    part = inner(link.part)
    if isinstance(part, Shaped):
        end = part.end
        yield Outline(link.name, link.frame, stack((part.span, end.height, end.width)), is_cylinder=end.is_axisymmetric)


def _prism(corners: Array, height: Array) -> Array:
    """Corners (..., 2 n, 3) of a prism over a polygon (..., n, 2)."""
    flat = np.concatenate([corners, corners], axis=-2)
    level = 0.5 * height[..., None] * np.repeat([-1.0, 1.0], corners.shape[-2])
    shape = np.broadcast_shapes(flat.shape[:-1], level.shape)
    return np.concatenate([np.broadcast_to(flat, (*shape, 2)), np.broadcast_to(level, shape)[..., None]], axis=-1)
