"""Convex polytopes in space: intersection, penetration depth and distance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.spatial.frame import Frame

_PARALLEL = 1e-9
"""Cross products of edges shorter than this are parallel and separate nothing."""


@dataclass(frozen=True, eq=False)
class Convex:
    """Convex polytope: corners `points` (n, 3) [m], unit `normals` (k, 3) of its faces, and unit vectors along its `edges` (m, 3)."""

    points: Array
    normals: Array
    edges: Array

    def within(self, frame: Frame) -> Convex:
        """Return this polytope in the parent frame of `frame`."""
        turn = frame.rotation.T
        return Convex(frame.position + self.points @ turn, self.normals @ turn, self.edges @ turn)

    @property
    def box(self) -> tuple[Array, Array]:
        """Lower and upper corner of the axis-parallel bounding box."""
        return self.points.min(axis=0), self.points.max(axis=0)


def cuboid(low: Sequence[float], high: Sequence[float]) -> Convex:
    """Build the box between two corners.

    >>> cuboid((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)).points.max(axis=0).tolist()
    [1.0, 2.0, 3.0]
    """
    corners = np.array(list(product(*zip(low, high, strict=True))), dtype=float)
    return Convex(corners, np.eye(3), np.eye(3))


@dataclass(frozen=True)
class Boxes:
    """Boxes: rotation matrices `turns` (..., 3, 3) with the box axes as columns, `centres` and half sizes `halves` (..., 3) [m]."""

    turns: Array
    centres: Array
    halves: Array

    def pick(self, which: Array) -> Boxes:
        """Return the boxes at the indices `which`, in that order."""
        return Boxes(self.turns[which], self.centres[which], self.halves[which])


def frustum(low: float, high: float, one: Array, other: Array) -> Convex:
    """Build the convex hull of two polygons: `one` (n, 2) in the plane x = `low`, `other` (n, 2) in the plane x = `high`.

    Corners of the polygons are (y, z), counter-clockwise; corresponding sides of both polygons are parallel.

    >>> square = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    >>> frustum(0.0, 2.0, square, square).points.max(axis=0).tolist()
    [2.0, 1.0, 1.0]
    """
    first, last = (np.column_stack([np.full(len(section), station), section]) for station, section in ((low, one), (high, other)))
    wide = first if np.ptp(first) >= np.ptp(last) else last
    rim, slant = np.roll(wide, -1, axis=0) - wide, last - first
    sides = np.cross(rim, slant)
    axis = np.array([[1.0, 0.0, 0.0]])
    return Convex(np.concatenate([first, last]), np.concatenate([axis, _unit(sides)]), np.concatenate([_unit(rim), _unit(slant)]))


def _unit(vectors: Array) -> Array:
    lengths = np.linalg.norm(vectors, axis=1)
    kept = lengths > 0.0
    return vectors[kept] / lengths[kept, None]


def separation(first: Convex, second: Convex) -> tuple[float, Array, float]:
    """Return the largest gap [m] between two polytopes over face normals and edge products, its direction, and the second largest gap.

    The unit direction points from the first to the second polytope; a negative gap is the penetration depth. The gap is exact for polytopes
    that intersect. For polytopes that do not intersect, it is a lower bound of the distance.

    >>> gap, direction, other = separation(cuboid((0, 0, 0), (1, 1, 1)), cuboid((0.9, 0.2, 0.0), (2, 1, 1)))
    >>> round(gap, 9), direction.tolist(), round(other, 9)
    (-0.1, [1.0, 0.0, 0.0], -0.8)
    """
    crossed = np.cross(first.edges[:, None], second.edges[None]).reshape(-1, 3)
    lengths = np.linalg.norm(crossed, axis=1)
    apart = lengths > _PARALLEL
    directions = np.concatenate([first.normals, second.normals, crossed[apart] / lengths[apart, None]])
    first_extent, second_extent = first.points @ directions.T, second.points @ directions.T
    ahead, behind = second_extent.min(axis=0) - first_extent.max(axis=0), first_extent.min(axis=0) - second_extent.max(axis=0)
    gaps = np.maximum(ahead, behind)
    widest = int(np.argmax(gaps))
    unit = directions[widest] * (1.0 if ahead[widest] >= behind[widest] else -1.0)
    others = gaps[np.abs(directions @ unit) < 0.999]
    return float(gaps[widest]), unit, float(np.max(others, initial=-np.inf))


def polytope_corners(normals: Array, offsets: Array) -> Array:
    """Compute the corners (n, 3) of a polytope of k faces: all points r with `normals` . r <= `offsets`; empty if there is no such point.

    >>> len(polytope_corners(np.concatenate([np.eye(3), -np.eye(3)]), np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])))
    8
    """
    planes = np.column_stack([normals, np.linalg.norm(normals, axis=1)])
    ball = scipy.optimize.linprog([0.0, 0.0, 0.0, -1.0], A_ub=planes, b_ub=offsets, bounds=(None, None))
    if ball.x is None or ball.x[3] <= 0.0:
        return np.zeros((0, 3))
    return scipy.spatial.HalfspaceIntersection(np.column_stack([normals, -offsets]), ball.x[:3]).intersections


def distance(first: Array, second: Array) -> float:
    """Compute the distance [m] between the convex hulls of two point sets (n, 3); 0 if the hulls intersect.

    The distance is the reciprocal of the length of the shortest vector w for which w . (b - a) >= 1 for all points a of the first and b of
    the second set. This vector is found by non-negative least squares (Lawson and Hanson 1974, chapter 23).

    >>> round(distance(cuboid((0, 0, 0), (1, 1, 1)).points, cuboid((2, 2, 0), (3, 3, 1)).points), 9)
    1.414213562
    """
    between = (second[None] - first[:, None]).reshape(-1, 3)
    scale = float(np.max(np.abs(between)))
    if scale == 0.0:
        return 0.0
    matrix = np.concatenate([between.T / scale, np.ones((1, len(between)))])
    try:
        weights, _ = scipy.optimize.nnls(matrix, np.array([0.0, 0.0, 0.0, 1.0]), maxiter=100 * matrix.shape[1])
    except RuntimeError:  # corners so close that rounding makes the selection cycle: the distance of two corners is as good
        return float(np.min(np.linalg.norm(between, axis=1)))
    residual = matrix @ weights - np.array([0.0, 0.0, 0.0, 1.0])
    size = float(np.linalg.norm(residual[:3]))
    return 0.0 if -residual[3] <= 1e-15 or size <= 1e-15 else scale * float(-residual[3]) / size


def separations(ones: Boxes, others: Boxes) -> Array:
    """Compute lower bounds (k,) [m] of the distances between k boxes and k other boxes, pair by pair; negative for boxes that intersect.

    A rotation matrix common to all boxes has shape (1, 3, 3).

    >>> box = Boxes(np.eye(3)[None], np.zeros((1, 3)), np.full((1, 3), 0.5))
    >>> other = Boxes(np.eye(3)[None], np.array([[2.0, 0.0, 0.0]]), np.full((1, 3), 0.5))
    >>> separations(box, other).tolist()
    [1.0]
    """
    turn, face = ones.turns, others.turns
    own_axes, other_axes = (each.mT for each in np.broadcast_arrays(turn, face))
    edges = np.cross(own_axes[:, :, None], other_axes[:, None]).reshape(-1, 9, 3)
    directions = np.concatenate([own_axes, other_axes, edges], axis=1)
    lengths = np.linalg.norm(directions, axis=-1, keepdims=True)
    units = np.divide(directions, lengths, out=np.zeros_like(directions), where=lengths > 1e-6)
    between = np.abs(np.einsum("kai,ki->ka", units, others.centres - ones.centres))
    own = np.einsum("kaj,kj->ka", np.abs(units @ turn), ones.halves) + np.einsum("kaj,kj->ka", np.abs(units @ face), others.halves)
    return np.max(np.where(lengths[..., 0] > 1e-6, between - own, -np.inf), axis=1)
