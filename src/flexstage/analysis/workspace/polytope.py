"""Polytope of reachable poses."""

from __future__ import annotations

from itertools import combinations
from typing import Annotated, ClassVar

import numpy as np
import scipy

from flexstage.analysis.workspace.stroke import StrokeLimits
from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, matvec
from flexstage.base.record import VIEW, Layout
from flexstage.base.units.quantity import RATIO
from flexstage.spatial.frame import MOTION

_MOST_VERTEX_CANDIDATES = 20_000
_TOLERANCE = 1e-9


class Polytope(Result):
    """Reachable poses {xi : `normals` xi <= `offsets`}: normals (..., 2 n, f), offsets (..., 2 n) [m].

    `vertices` (..., v, f) [m, rad] are padded with NaN for designs with fewer vertices; `volume` (...) is in `volume_unit`.
    """

    TABLE: ClassVar[Layout] = Layout("Reachable extents, other coordinates free", "extent")

    coordinates: tuple[str, ...]
    normals: Array
    offsets: Array
    vertices: Array
    volume: Annotated[Array, RATIO]
    volume_unit: str
    provenance: str

    def contains(self, pose: Array) -> Array:
        """Return whether poses (..., f) [m, rad] can be reached; the boundary is included."""
        used = matvec(self.normals, pose)
        return np.all(used <= self.offsets + _TOLERANCE * np.abs(self.offsets), axis=-1)

    @property
    def poses(self) -> Annotated[Matrix, VIEW]:
        """Vertices of the polytope; supported only for a single design."""
        known = self.vertices[~np.isnan(self.vertices).any(axis=-1)]
        units = tuple(map(MOTION.unit, self.coordinates))
        return Matrix(known, tuple(str(number + 1) for number in range(len(known))), self.coordinates, (units,) * len(known))

    @property
    def extent(self) -> Annotated[Matrix, VIEW]:
        """Least and largest value of each coordinate (rows), with the other coordinates free."""
        values = np.stack([np.nanmin(self.vertices, axis=-2), np.nanmax(self.vertices, axis=-2)], axis=-1)
        units = tuple((MOTION.unit(name),) * 2 for name in self.coordinates)
        return Matrix(values, self.coordinates, ("least", "largest"), units)


def reachable(mapping: Matrix, limits: StrokeLimits, *, provenance: str = "") -> Polytope:
    """Compute the polytope of poses xi with low <= R_a xi <= high. `mapping` is R_a, as for `single_axis`.

    With as many strokes as coordinates, the polytope is a parallelotope. Its vertices are R_a^-1 a for all corners a of the strokes, and
    its volume is prod(full strokes) / |det R_a|.

    >>> square = reachable(Matrix(np.diag([1.0, 2.0]), ("A", "B"), ("x", "y"), "1"), StrokeLimits(("A", "B"), -np.ones(2), np.ones(2)))
    >>> float(square.volume), bool(square.contains(np.array([1.0, 0.5]))), bool(square.contains(np.array([1.0, 0.6])))
    (2.0, True, False)
    """
    normals = np.concatenate([mapping.values, -mapping.values], axis=-2)
    offsets = np.concatenate([limits.high, -limits.low], axis=-1)
    if len(mapping.rows) == len(mapping.columns):
        inverse = np.linalg.inv(mapping.values)
        vertices = limits.corners @ inverse.mT
        volume = np.prod(limits.full, axis=-1) * np.abs(np.linalg.det(inverse))
    else:
        vertices, volume = _redundant(normals, np.broadcast_to(offsets, normals.shape[:-1]))
    return Polytope(mapping.columns, normals, offsets, vertices, volume, _volume_unit(mapping.columns), provenance)


def _volume_unit(coordinates: tuple[str, ...]) -> str:
    turns = sum(name.startswith("r") for name in coordinates)
    powers = (("m", len(coordinates) - turns), ("rad", turns))
    return " ".join(unit if power == 1 else f"{unit}^{power}" for unit, power in powers if power)


def _redundant(normals: Array, offsets: Array) -> tuple[Array, Array]:
    """Vertices and volumes for redundant strokes: every feasible intersection of f faces, design by design."""
    flat = [
        _crossings(*design) for design in zip(normals.reshape(-1, *normals.shape[-2:]), offsets.reshape(-1, offsets.shape[-1]), strict=True)
    ]
    most = max(len(vertices) for vertices in flat)
    padded = [np.concatenate([item, np.full((most - len(item), item.shape[1]), np.nan)]) for item in flat]
    volumes = np.array([_hull_volume(item) for item in flat])
    lead = normals.shape[:-2]
    return np.stack(padded).reshape(*lead, most, normals.shape[-1]), volumes.reshape(lead)


def _crossings(normals: Array, offsets: Array) -> Array:
    count, size = normals.shape
    half = count // 2
    choices = [choice for choice in combinations(range(count), size) if len({index % half for index in choice}) == size]
    if len(choices) > _MOST_VERTEX_CANDIDATES:
        what = f"too many candidate vertices for {half} strokes (got {len(choices)}, expected {_MOST_VERTEX_CANDIDATES} or fewer)"
        raise refuse("reachable polytope", what, "Check poses by low <= R_a xi <= high")
    picked = np.array(choices)
    square = normals[picked]
    scale = np.linalg.norm(normals, axis=0)
    regular = np.abs(np.linalg.det(square / scale)) > _TOLERANCE
    points = np.linalg.solve(square[regular], offsets[picked][regular][..., None])[..., 0]
    inside = np.all(points @ normals.T <= offsets + _TOLERANCE * np.abs(offsets), axis=-1)
    result = points[inside]
    size_of = np.max(np.abs(result), axis=0)
    _, first = np.unique(np.round(result / size_of, 8) + 0.0, axis=0, return_index=True)
    return result[np.sort(first)]


def _hull_volume(vertices: Array) -> float:
    if vertices.shape[1] == 1:
        return float(np.ptp(vertices))
    scale = np.max(np.abs(vertices), axis=0)
    return float(scipy.spatial.ConvexHull(vertices / scale).volume * np.prod(scale))
