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

    sides = faces

    def flat_faces(self) -> Iterator[tuple[Face, Array]]:
        """None that are better known than by points."""
        yield from ()


@dataclass(frozen=True, eq=False)
class Path:
    """A piece of the rim of a section: the face it is of, places (b, n, 2), p x dp and the lengths (b, n) that they stand for."""

    face: Face
    places: Array
    turn: Array
    lengths: Array


@dataclass(frozen=True, eq=False)
class Prism:
    """The surface of prisms along the x axis of a frame, between `ends` (b,) in the planes `caps` (b,), with the moments of the section."""

    designs: Array
    frame: Frame
    ends: tuple[Array, Array]
    caps: tuple[Array, Array]
    paths: tuple[Path, ...]
    section: tuple[Array, Array, Array]

    def sides(self) -> Iterator[tuple[Face, Points]]:
        """Each face along the axis, by points that are exact for cubics."""
        low, high = self.ends
        for path in self.paths:
            along = 0.5 * (low + high)[:, None] + (high - low)[:, None] * _HALVES
            places = [self._placed(along[:, [number]], path.places) for number in range(len(_HALVES))]
            weights = (path.lengths * (high - low)[:, None])[:, None] * _HALF_WEIGHTS[:, None]
            yield path.face, (np.concatenate(places, axis=1), weights.reshape(len(low), -1))

    def faces(self) -> Iterator[tuple[Face, Points]]:
        """Each face, by points that are exact for cubics."""
        yield from self.sides()
        flat = np.concatenate([path.places for path in self.paths], axis=1)
        turn = np.concatenate([path.turn for path in self.paths], axis=1)
        share = 0.5 + _RAYS
        weights = (turn[:, None] * (share * _RAY_WEIGHTS)[:, None]).reshape(len(flat), -1)
        for end, caps in zip(self.ends, self.caps, strict=True):
            places = self._placed(end[:, None], (flat[:, None] * share[:, None, None]).reshape(len(flat), -1, 2))
            for cap in np.unique(caps):
                yield (PLANE, int(cap)), (places, weights * (caps == cap)[:, None])

    def flat_faces(self) -> Iterator[tuple[Face, Array]]:
        """Integrals of the functions over the planes at its ends (b, 10)."""
        area, first, second = self.section
        across = self.frame.rotation[..., 1:]
        arm = (across @ first[..., None])[..., 0]
        own = across @ second @ np.swapaxes(across, -1, -2)
        for end, caps in zip(self.ends, self.caps, strict=True):
            middle = self.frame.position + end[:, None] * self.frame.rotation[..., 0]
            cross = middle[:, :, None] * arm[:, None]
            both = own + cross + np.swapaxes(cross, -1, -2) + area[:, None, None] * middle[:, :, None] * middle[:, None]
            found = _in_order(area, arm + area[:, None] * middle, both)
            for cap in np.unique(caps):
                yield (PLANE, int(cap)), found * (caps == cap)[:, None]

    def take(self, designs: Array) -> Prism:
        """That of some designs."""
        frame = Frame(self.frame.rotation[designs], self.frame.position[designs])
        paths = tuple(Path(path.face, path.places[designs], path.turn[designs], path.lengths[designs]) for path in self.paths)
        (low, high), (bottom, top) = self.ends, self.caps
        area, first, second = (each[designs] for each in self.section)
        return Prism(designs, frame, (low[designs], high[designs]), (bottom[designs], top[designs]), paths, (area, first, second))

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


def gains(surfaces: Sequence[Surface], rounds: Sequence[tuple[Array, Array]], count: int, *, turning: bool) -> dict[Face, Array]:
    """By face: what takes the rates of the numbers that place it to those of the moments (b, 10, 4 or 7).

    `rounds` are axes and points (b, 3) of the cylinders. Unless planes are `turning`, those of their offsets alone (b, 10, 1).
    """
    found: dict[Face, Array] = {}
    for surface in surfaces:
        for face, gain in _face_gains(surface, rounds, turning=turning):
            known = found.setdefault(face, np.zeros((count, *gain.shape[1:])))
            known[surface.designs] += gain
    return found


def _face_gains(surface: Surface, rounds: Sequence[tuple[Array, Array]], *, turning: bool) -> Iterator[tuple[Face, Array]]:
    for face, (places, weights) in surface.faces() if turning else surface.sides():
        kind, number = face
        if kind == ROUND:
            own = (each[surface.designs] for each in rounds[number])
            yield face, (moment_functions(places) * weights[:, None]) @ round_motions(places, *own)
        elif turning:
            yield face, (moment_functions(places) * weights[:, None]) @ plane_motions(places)
        else:
            yield face, _moments(places, weights)[..., None]
    if not turning:
        yield from ((face, moments[..., None]) for face, moments in surface.flat_faces())


def _moments(places: Array, weights: Array) -> Array:
    """Integrals of the functions over a face (b, 10)."""
    weighted = places * weights[..., None]
    return _in_order(np.sum(weights, axis=1), np.sum(weighted, axis=1), np.swapaxes(places, -1, -2) @ weighted)


def _in_order(volume: Array, first: Array, second: Array) -> Array:
    ends = [volume[:, None], first, np.diagonal(second, axis1=-2, axis2=-1)]
    return np.concatenate([*ends, second[:, [0, 0, 1], [1, 2, 2]]], axis=1)
