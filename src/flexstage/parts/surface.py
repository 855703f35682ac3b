"""How the moments of a region change as its surface moves: integrals over the surface, one for every way a face can move.

Moments are the integrals of f = 1, r, r r^T over a region; where a face moves outward by v(r), they change by the integral of f v over it
(Reynolds' transport theorem). A plane n . r = b moves by b' - n' . r, the side of a cylinder |P (r - p)| = R about the axis a by
R' + e . p' + h e . a', e the radial direction and h = a . (r - p). So every face has a small matrix from the numbers that place it to the
moments, known from the region alone, and derivatives by any number are products with it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.spatial.frame import Frame

_CORNERS: Array = np.array([[1.0, 1.0, 1.0], [1.8, 0.6, 0.6], [0.6, 1.8, 0.6], [0.6, 0.6, 1.8]]) / 3.0
_SHARES: Array = np.array([-27.0, 25.0, 25.0, 25.0]) / 48.0
"""A rule on triangles that is exact for cubics (Strang and Fix 1973)."""
_HALVES, _HALF_WEIGHTS = (0.5 * each for each in np.polynomial.legendre.leggauss(2))
_RAYS, _RAY_WEIGHTS = (0.5 * each for each in np.polynomial.legendre.leggauss(3))

PLANE, ROUND = "plane", "round"

Face: TypeAlias = tuple[str, int]
"""A plane or a round of a cell, by its number."""

Points: TypeAlias = tuple[Array, Array]
"""Places (b, n, 3) on a face and the areas (b, n) that they stand for."""


@dataclass(frozen=True, eq=False)
class Hull:
    """The surface of polytopes: `places` (b, v, 3) of their corners, `triangles` (n, 3) of them, and the plane that each lies in."""

    designs: Array
    places: Array
    triangles: Array
    planes: Array

    def faces(self) -> Iterator[tuple[Face, Points]]:
        """Each face, by points that are exact for cubics."""
        for plane in np.unique(self.planes):
            corners = self.places[:, self.triangles[self.planes == plane]]
            first, second = (corners[:, :, number] - corners[:, :, 0] for number in (1, 2))
            normal = np.cross(first, second)
            area = 0.5 * np.sqrt(np.sum(normal * normal, axis=-1))
            weights = area[..., None] * _SHARES
            yield (PLANE, int(plane)), ((_CORNERS @ corners).reshape(len(corners), -1, 3), weights.reshape(len(corners), -1))


@dataclass(frozen=True, eq=False)
class Path:
    """A piece of the rim of a section: the face it is of, places (b, n, 2), p x dp and the lengths (b, n) that they stand for."""

    face: Face
    places: Array
    turn: Array
    lengths: Array


@dataclass(frozen=True, eq=False)
class Prism:
    """The surface of prisms along the x axis of a frame, from `low` to `high` (b,), whose planes are `caps` (b,)."""

    designs: Array
    frame: Frame
    ends: tuple[Array, Array]
    caps: tuple[Array, Array]
    paths: tuple[Path, ...]

    def faces(self) -> Iterator[tuple[Face, Points]]:
        """Each face, by points that are exact for cubics."""
        low, high = self.ends
        for path in self.paths:
            along = 0.5 * (low + high)[:, None] + (high - low)[:, None] * _HALVES
            places = [self._placed(along[:, [number]], path.places) for number in range(len(_HALVES))]
            weights = (path.lengths * (high - low)[:, None])[:, None] * _HALF_WEIGHTS[:, None]
            yield path.face, (np.concatenate(places, axis=1), weights.reshape(len(low), -1))
        flat = np.concatenate([path.places for path in self.paths], axis=1)
        turn = np.concatenate([path.turn for path in self.paths], axis=1)
        share = 0.5 + _RAYS
        weights = (turn[:, None] * (share * _RAY_WEIGHTS)[:, None]).reshape(len(low), -1)
        for end, caps in zip(self.ends, self.caps, strict=True):
            places = self._placed(end[:, None], (flat[:, None] * share[:, None, None]).reshape(len(flat), -1, 2))
            for cap in np.unique(caps):
                yield (PLANE, int(cap)), (places, weights * (caps == cap)[:, None])

    def take(self, designs: Array) -> Prism:
        """That of some designs."""
        frame = Frame(self.frame.rotation[designs], self.frame.position[designs])
        paths = tuple(Path(path.face, path.places[designs], path.turn[designs], path.lengths[designs]) for path in self.paths)
        (low, high), (bottom, top) = self.ends, self.caps
        return Prism(designs, frame, (low[designs], high[designs]), (bottom[designs], top[designs]), paths)

    def _placed(self, along: Array, across: Array) -> Array:
        turn = self.frame.rotation
        start = self.frame.position[:, None] + along[..., None] * turn[:, None, :, 0]
        return start + across @ np.swapaxes(turn[..., 1:], -1, -2)


Surface: TypeAlias = Hull | Prism


def hull_planes(hull: scipy.spatial.ConvexHull, normals: Array, offsets: Array, scale: float) -> Array:
    """Which of the planes (k,) each triangle of a hull of places over `scale` lies in."""
    steep = hull.equations[:, :3] @ normals.T
    return np.argmin(np.abs(1.0 - steep) + np.abs(hull.equations[:, 3:] + offsets / scale), axis=1)


def moment_functions(places: Array) -> Array:
    """1, x, y, z, xx, yy, zz, xy, xz, yz at places (b, n, 3) -> (b, 10, n).

    >>> moment_functions(np.array([[[1.0, 2.0, 3.0]]]))[0, :, 0].tolist()
    [1.0, 1.0, 2.0, 3.0, 1.0, 4.0, 9.0, 2.0, 3.0, 6.0]
    """
    x, y, z = np.moveaxis(places, -1, 0)
    return np.stack([np.ones_like(x), x, y, z, x * x, y * y, z * z, x * y, x * z, y * z], axis=1)


def plane_motions(places: Array) -> Array:
    """By how much a plane moves outward at places, by the rate of its offset and those of its normal (b, n, 4)."""
    return np.concatenate([np.ones_like(places[..., :1]), -places], axis=-1)


def round_motions(places: Array, axis: Array, point: Array) -> Array:
    """By how much the side of a cylinder moves outward at places, by the rates of its radius, point and axis (b, n, 7)."""
    arm = places - point[:, None]
    height = np.sum(arm * axis[:, None], axis=-1, keepdims=True)
    radial = arm - height * axis[:, None]
    radial = radial / np.sqrt(np.sum(radial * radial, axis=-1, keepdims=True))
    return np.concatenate([np.ones_like(height), radial, height * radial], axis=-1)


def gains(surfaces: Sequence[Surface], rounds: Sequence[tuple[Array, Array]], count: int) -> dict[Face, Array]:
    """By face: what takes the rates of the numbers that place it to those of the moments (b, 10, 4 or 7).

    `rounds` are axes and points (b, 3) of the cylinders.
    """
    found: dict[Face, Array] = {}
    for surface in surfaces:
        for face, (places, weights) in surface.faces():
            kind, number = face
            own = [each[surface.designs] for each in rounds[number]] if kind == ROUND else []
            motions = round_motions(places, *own) if kind == ROUND else plane_motions(places)
            gain = (moment_functions(places) * weights[:, None]) @ motions
            known = found.setdefault(face, np.zeros((count, *gain.shape[1:])))
            known[surface.designs] += gain
    return found
